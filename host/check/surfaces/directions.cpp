#include "check/surfaces/directions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/statistics.hpp"

namespace clarity::check {
namespace {

constexpr size_t kFirstDraws = 20000;  // that decide on the cells
constexpr double kMostOfCell = 160;    // of these, drawn or expected
constexpr double kGreatestSide = 1.0 / 8;
constexpr double kLeastExpected = 20;  // draws of a cell; others are put together

Integrals density_of(const SurfaceQuery&, const SurfaceAnswer& answer) {
    return {double(answer.density)};
}

// Where directions were drawn, and with which density.
std::vector<Hint> hints_of(const std::vector<SurfaceAnswer>& drawn) {
    std::vector<Hint> hints;
    for (const SurfaceAnswer& answer : drawn)
        if (answer.drawn()) hints.push_back({place_of(answer.wi), double(answer.drawn_density)});
    return hints;
}

}  // namespace

std::vector<SurfaceQuery> random_draws(const float* wo, size_t count, std::mt19937& random) {
    std::vector<SurfaceQuery> queries(count);
    for (SurfaceQuery& query : queries) {
        std::copy_n(wo, 3, query.wo);
        set_direction(1, 0, query.wi);
        for (float& u : query.u) u = float(random() >> 8) * 0x1p-24f;
    }
    return queries;
}

DrawCells::DrawCells(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo, std::mt19937& random) {
    const auto hints = hints_of(probe.ask(subject, random_draws(wo, kFirstDraws, random)));
    nodes_.emplace_back();
    const auto split = [&](size_t n) {
        nodes_[n].parts = int(nodes_.size());
        for (int k = 0; k < 4; ++k) {
            Node part;
            part.cell = nodes_[n].cell.part(k);
            nodes_.push_back(part);
        }
    };
    // Cells in which many were drawn. The parts of a cell are behind it.
    std::vector<std::vector<Place>> places(1);
    for (const Hint& hint : hints) places[0].push_back(hint.place);
    for (size_t n = 0; n < nodes_.size(); ++n) {
        const double side = nodes_[n].cell.side;
        if (side <= 2 * kLeastSide || (side <= kGreatestSide && double(places[n].size()) <= kMostOfCell)) continue;
        split(n);
        places.resize(nodes_.size());
        for (const Place& place : places[n]) places[size_t(nodes_[n].parts + nodes_[n].cell.part_of(place))].push_back(place);
        places[n] = {};
    }
    // And those in which many should be.
    for (size_t first = 0; first < nodes_.size();) {
        std::vector<size_t> fresh;
        std::vector<SquareCell> cells;
        for (; first < nodes_.size(); ++first)
            if (nodes_[first].parts < 0) fresh.push_back(first), cells.push_back(nodes_[first].cell);
        const auto shares = integrate(probe, subject, wo, cells, hints, density_of);
        for (size_t i = 0; i < fresh.size(); ++i) {
            nodes_[fresh[i]].share = shares[i][0];
            if (shares[i][0] * double(kFirstDraws) > kMostOfCell && cells[i].side > 2 * kLeastSide) split(fresh[i]);
        }
    }
    for (const Node& node : nodes_)
        if (node.parts < 0) total_ += node.share;
}

size_t DrawCells::leaf_of(Place place) const {
    size_t at = 0;
    while (nodes_[at].parts >= 0) at = size_t(nodes_[at].parts + nodes_[at].cell.part_of(place));
    return at;
}

Misfit DrawCells::misfit_of(const std::vector<SurfaceAnswer>& drawn) const {
    std::vector<double> count(nodes_.size());
    const double draws = double(drawn.size());
    // Draws without a direction are a count of their own: the density's integral leaves them.
    double rest_count = 0, rest_expected = std::max(0.0, 1 - total_) * draws;
    for (const SurfaceAnswer& answer : drawn)
        if (answer.drawn())
            ++count[leaf_of(place_of(answer.wi))];
        else
            ++rest_count;
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
    for (size_t n = 0; n < nodes_.size(); ++n) {
        if (nodes_[n].parts >= 0) continue;
        const double wanted = nodes_[n].share * draws;
        if (wanted < kLeastExpected) {
            rest_count += count[n];
            rest_expected += wanted;
            continue;
        }
        float middle[3];
        set_direction(nodes_[n].cell.middle(), middle);
        add(count[n], wanted, "near the direction " + direction_text(middle));
    }
    if (rest_expected > kLeastExpected || rest_count > 3 * kLeastExpected)
        add(rest_count, std::max(rest_expected, 1.0), "without a direction, or where the density is low,");
    misfit.sigmas = normal_of_chi_square(chi_square, std::max(1.0, degrees));
    return misfit;
}

}  // namespace clarity::check
