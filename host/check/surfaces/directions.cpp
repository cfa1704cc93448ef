#include "check/surfaces/directions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "base/angle.hpp"
#include "base/statistics.hpp"

namespace clarity::check {
namespace {

constexpr int kUp = 20, kAround = 32, kCells = kUp * kAround;
constexpr double kCellAngle = 2 * kPi / kCells;  // sr
constexpr double kLeastExpected = 20;            // draws of a cell; others are put together

void set_in_cell(int cell, double up, double around, float* w) {
    set_direction((cell / kAround + up) / kUp, (cell % kAround + around) / kAround, w);
}

struct CellDensity {
    double mean = 0, greatest = 0;
};
// By the middles of side x side parts of equal solid angle.
std::vector<CellDensity> densities(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo,
                                   const std::vector<int>& cells, int side) {
    std::vector<CellDensity> found(cells.size());
    const int parts = side * side;
    const size_t at_once = std::max(1, (1 << 18) / parts);  // 25 MB of queries and answers
    for (size_t first = 0; first < cells.size(); first += at_once) {
        const size_t end = std::min(first + at_once, cells.size());
        std::vector<SurfaceQuery> queries((end - first) * size_t(parts));
        for (size_t i = 0; i < queries.size(); ++i) {
            const int part = int(i) % parts;
            std::copy_n(wo, 3, queries[i].wo);
            std::fill_n(queries[i].u, 3, 0.5f);
            set_in_cell(cells[first + i / size_t(parts)], (part / side + 0.5) / side, (part % side + 0.5) / side,
                        queries[i].wi);
        }
        const auto answers = probe.ask(subject, queries);
        for (size_t i = 0; i < answers.size(); ++i) {
            CellDensity& cell = found[first + i / size_t(parts)];
            cell.mean += double(answers[i].density) / parts;
            cell.greatest = std::max(cell.greatest, double(answers[i].density));
        }
    }
    return found;
}

}  // namespace

void set_direction(double z, double turn, float* w) {
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    w[0] = float(r * std::cos(2 * kPi * turn));
    w[1] = float(r * std::sin(2 * kPi * turn));
    w[2] = float(z);
}

std::string direction_text(const float* w) {
    char text[80];
    std::snprintf(text, sizeof text, "(%.9g, %.9g, %.9g)", double(w[0]), double(w[1]), double(w[2]));
    return text;
}

std::vector<SurfaceQuery> random_draws(const float* wo, size_t count, std::mt19937& random) {
    std::vector<SurfaceQuery> queries(count);
    for (SurfaceQuery& query : queries) {
        std::copy_n(wo, 3, query.wo);
        set_direction(1, 0, query.wi);
        for (float& u : query.u) u = float(random() >> 8) * 0x1p-24f;
    }
    return queries;
}

CellShares shares_of(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo) {
    std::vector<int> cells(kCells), uneven;
    std::iota(cells.begin(), cells.end(), 0);
    std::vector<CellDensity> found = densities(probe, subject, wo, cells, 8);
    for (const int c : cells)
        if (found[size_t(c)].greatest > 2 * found[size_t(c)].mean) uneven.push_back(c);
    const auto fine = densities(probe, subject, wo, uneven, 64);
    for (size_t i = 0; i < uneven.size(); ++i) found[size_t(uneven[i])] = fine[i];
    CellShares shares;
    for (const CellDensity& cell : found) {
        shares.shares.push_back(cell.mean * kCellAngle);
        shares.total += shares.shares.back();
    }
    return shares;
}

Misfit misfit_of(const std::vector<SurfaceAnswer>& drawn, const CellShares& expected) {
    std::vector<double> count(kCells);
    double nothing = 0;
    for (const SurfaceAnswer& answer : drawn) {
        if (!answer.drawn()) {
            ++nothing;
            continue;
        }
        const double turn = std::atan2(answer.wi[1], answer.wi[0]) / (2 * kPi);
        const int up = std::clamp(int(answer.wi[2] * kUp), 0, kUp - 1);
        const int around = std::clamp(int((turn < 0 ? turn + 1 : turn) * kAround), 0, kAround - 1);
        ++count[size_t(up * kAround + around)];
    }
    const double draws = double(drawn.size());
    Misfit misfit;
    double chi_square = 0, degrees = -1, worst = 0;
    const auto add = [&](double found, double wanted, const std::string& where) {
        const double part = (found - wanted) * (found - wanted) / wanted;
        chi_square += part;
        ++degrees;
        if (part <= worst) return;
        worst = part;
        char text[96];
        std::snprintf(text, sizeof text, " %.0f of %.0f draws, expected %.0f", found, draws, wanted);
        misfit.worst = where + text;
    };
    // Draws without a direction are a count of their own: the density's integral leaves them.
    double rest_count = nothing, rest_expected = std::max(0.0, 1 - expected.total) * draws;
    for (int c = 0; c < kCells; ++c) {
        const double wanted = expected.shares[size_t(c)] * draws;
        if (wanted < kLeastExpected) {
            rest_count += count[size_t(c)];
            rest_expected += wanted;
            continue;
        }
        float middle[3];
        set_in_cell(c, 0.5, 0.5, middle);
        add(count[size_t(c)], wanted, "near the direction " + direction_text(middle));
    }
    if (rest_expected > kLeastExpected || rest_count > 3 * kLeastExpected)
        add(rest_count, std::max(rest_expected, 1.0), "without a direction, or where the density is low,");
    misfit.sigmas = normal_of_chi_square(chi_square, std::max(1.0, degrees));
    return misfit;
}

}  // namespace clarity::check
