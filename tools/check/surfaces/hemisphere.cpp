#include "tools/check/surfaces/hemisphere.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/angle.hpp"
#include "base/statistics.hpp"

namespace clarity::check {
namespace {

constexpr int kAlong = 3, kPlaces = kAlong * kAlong;  // of a cell: Gauss and Legendre's, exact up to degree 5
constexpr double kNodes[kAlong] = {0.1127016653792583, 0.5, 0.8872983346207417};
constexpr double kWeights[kAlong] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
constexpr double kSteady = 2e-3;            // by this share the parts of a cell may differ from it
constexpr double kOfAll = 1e-6;             // or by this share of the whole integral
constexpr double kLeastAtMirror = 0x1p-13;  // side of cells there
constexpr size_t kMostAsked = 3'000'000;    // directions; what is then not known well is taken as it is
constexpr size_t kAtOnce = 1 << 18;         // 25 MB of queries and answers

// A cell on the way to be known.
struct Open {
    SquareCell cell;
    size_t owner = 0;  // among the cells that are asked for
    Integrals integrals{};
    double greatest = 0;          // of the first number
    std::vector<uint32_t> hints;  // within the cell
};

class Integration {
 public:
    Integration(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo, const std::vector<Hint>& hints,
                const Integrand& integrand)
        : probe_(probe), subject_(subject), wo_(wo), hints_(hints), integrand_(integrand) {
        const float mirror[3] = {-wo[0], -wo[1], wo[2]};
        mirror_ = place_of(mirror);
    }

    std::vector<Integrals> over(const std::vector<SquareCell>& cells) {
        std::vector<Integrals> found(cells.size());
        std::vector<Open> open(cells.size());
        for (size_t i = 0; i < cells.size(); ++i) open[i].cell = cells[i], open[i].owner = i;
        give_hints(cells, open);
        ask(open);
        Integrals all{};
        for (const Open& one : open) add(all, one.integrals);
        while (!open.empty()) {
            std::vector<Open> parts;
            parts.reserve(4 * open.size());
            for (const Open& one : open) split(one, parts);
            ask(parts);
            std::vector<Open> next;
            const bool is_last = asked_ > kMostAsked || parts.front().cell.side <= kLeastSide;
            for (size_t i = 0; i < open.size(); ++i) {
                Integrals sum{};
                for (size_t k = 0; k < 4; ++k) add(sum, parts[4 * i + k].integrals);
                for (size_t n = 0; n < sum.size(); ++n) all[n] += sum[n] - open[i].integrals[n];
                if (is_last || is_known(open[i], &parts[4 * i], sum, all))
                    add(found[open[i].owner], sum);
                else
                    for (size_t k = 0; k < 4; ++k) next.push_back(std::move(parts[4 * i + k]));
            }
            open = std::move(next);
        }
        return found;
    }

 private:
    static void add(Integrals& sum, const Integrals& of) {
        for (size_t n = 0; n < sum.size(); ++n) sum[n] += of[n];
    }
    // Of each cell, those that it holds. Cells are few and of any size.
    void give_hints(const std::vector<SquareCell>& cells, std::vector<Open>& open) const {
        for (uint32_t h = 0; h < hints_.size(); ++h) {
            const Place at = hints_[h].place;
            for (size_t i = 0; i < cells.size(); ++i)
                if (at.x >= cells[i].x && at.x < cells[i].x + cells[i].side && at.y >= cells[i].y &&
                    at.y < cells[i].y + cells[i].side)
                    open[i].hints.push_back(h);
        }
    }
    void split(const Open& one, std::vector<Open>& parts) const {
        const size_t first = parts.size();
        for (int k = 0; k < 4; ++k) {
            parts.emplace_back();
            parts.back().cell = one.cell.part(k), parts.back().owner = one.owner;
        }
        for (const uint32_t h : one.hints) parts[first + size_t(one.cell.part_of(hints_[h].place))].hints.push_back(h);
    }
    void ask(std::vector<Open>& open) {
        const size_t step = kAtOnce / kPlaces;
        for (size_t first = 0; first < open.size(); first += step) {
            const size_t end = std::min(first + step, open.size());
            std::vector<SurfaceQuery> queries((end - first) * kPlaces);
            for (size_t i = 0; i < queries.size(); ++i) {
                const SquareCell& cell = open[first + i / kPlaces].cell;
                const size_t place = i % kPlaces;
                std::copy_n(wo_, 3, queries[i].wo);
                std::fill_n(queries[i].u, 3, 0.5f);
                set_direction({cell.x + cell.side * kNodes[place / kAlong], cell.y + cell.side * kNodes[place % kAlong]},
                              queries[i].wi);
            }
            const auto answers = probe_.ask(subject_, queries);
            asked_ += queries.size();
            for (size_t i = 0; i < answers.size(); ++i) {
                Open& one = open[first + i / kPlaces];
                const size_t place = i % kPlaces;
                const Integrals values = integrand_(queries[i], answers[i]);
                const double angle =
                    2 * kPi * one.cell.side * one.cell.side * kWeights[place / kAlong] * kWeights[place % kAlong];
                for (size_t n = 0; n < values.size(); ++n) one.integrals[n] += values[n] * angle;
                one.greatest = std::max(one.greatest, values[0]);
            }
        }
    }
    bool is_known(const Open& one, const Open* parts, const Integrals& sum, const Integrals& all) const {
        const double side = one.cell.side;
        const Place middle = one.cell.middle();
        if (side > kLeastAtMirror && std::fabs(middle.x - mirror_.x) < 1.5 * side &&
            std::fabs(middle.y - mirror_.y) < 1.5 * side)
            return false;
        for (size_t n = 0; n < sum.size(); ++n)
            if (std::fabs(sum[n] - one.integrals[n]) > kSteady * std::fabs(sum[n]) + kOfAll * std::fabs(all[n])) return false;
        for (int k = 0; k < 4; ++k)
            for (const uint32_t h : parts[k].hints)
                if (hints_[h].value > 3 * parts[k].greatest) return false;
        return true;
    }

    SurfaceProbe& probe_;
    const SurfaceSubject& subject_;
    const float* wo_;
    const std::vector<Hint>& hints_;
    const Integrand& integrand_;
    Place mirror_;
    size_t asked_ = 0;
};

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

void set_direction(Place place, float* w) {
    const double a = 2 * place.x - 1, b = 2 * place.y - 1;
    const bool wide = std::fabs(a) > std::fabs(b);
    const double r = wide ? a : b;
    const double angle = r == 0 ? 0 : wide ? kPi / 4 * (b / a) : kPi / 2 - kPi / 4 * (a / b);
    const double across = r * std::sqrt(2 - r * r);  // the root of 1 - z^2, where z = 1 - r^2
    w[0] = float(across * std::cos(angle));
    w[1] = float(across * std::sin(angle));
    w[2] = float(1 - r * r);
}

Place place_of(const float* w) {
    const double x = w[0], y = w[1], across = std::hypot(x, y);
    if (across == 0) return {0.5, 0.5};
    // 1 - z without the digits that are lost where z is near 1.
    const double r = std::min(1.0, across / std::sqrt(std::hypot(across, double(w[2])) + double(w[2])));
    double a, b;
    if (std::fabs(x) > std::fabs(y)) {
        a = x > 0 ? r : -r;
        b = a * std::atan(y / x) * 4 / kPi;
    } else {
        b = y > 0 ? r : -r;
        a = b * std::atan(x / y) * 4 / kPi;
    }
    const auto within = [](double t) { return std::clamp((t + 1) / 2, 0.0, 1 - 0x1p-30); };
    return {within(a), within(b)};
}

SquareCell SquareCell::part(int number) const {
    return {x + (number & 1 ? side / 2 : 0), y + (number & 2 ? side / 2 : 0), side / 2};
}

std::vector<SquareCell> even_cells(int along_side) {
    std::vector<SquareCell> cells;
    for (int i = 0; i < along_side * along_side; ++i)
        cells.push_back({double(i % along_side) / along_side, double(i / along_side) / along_side, 1.0 / along_side});
    return cells;
}

std::vector<Integrals> integrate(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo,
                                 const std::vector<SquareCell>& cells, const std::vector<Hint>& hints,
                                 const Integrand& integrand) {
    return Integration(probe, subject, wo, hints, integrand).over(cells);
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
