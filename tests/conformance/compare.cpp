#include "conformance/compare.hpp"

#include <algorithm>
#include <cstdio>

namespace clarity::test {
namespace {

constexpr size_t kLookedAt = 1000;

// Two units in the last place of the origin's largest coordinate, as a distance along the ray.
double rounding_of_origin(const Ray& ray) {
    double largest = 0, dd = 0;
    for (int k = 0; k < 3; ++k) {
        largest = std::max(largest, std::fabs(ray.origin[k]));
        dd += ray.direction[k] * ray.direction[k];
    }
    return 2.4e-7 * largest / std::sqrt(dd);
}

}  // namespace

void Comparison::add(const Comparison& other) {
    rays += other.rays;
    hits += other.hits;
    missed += other.missed;
    invented += other.invented;
    elsewhere += other.elsewhere;
    grazing += other.grazing;
    overruled += other.overruled;
    other_prim += other.other_prim;
    ties += other.ties;
    worst_t = std::max(worst_t, other.worst_t);
    if (first.empty()) first = other.first;
}

std::string Comparison::text() const {
    char line[512];
    std::snprintf(line, sizeof line,
                  "%zu rays, %zu hits: %zu missed, %zu invented, %zu elsewhere (%zu of them grazing), %zu of all overruled, "
                  "worst t %.1e, %zu ties, %zu wrong prims%s%s",
                  rays, hits, missed, invented, elsewhere, grazing, overruled, worst_t, ties, other_prim,
                  first.empty() ? "" : "; first: ", first.c_str());
    return line;
}

Comparison compare(const Oracle& oracle, const std::vector<Truth>& truth, const std::vector<Ray>& rays, const FloatPixels& t,
                   const FloatPixels* prims) {
    Comparison c;
    c.rays = truth.size();
    for (size_t i = 0; i < truth.size(); ++i) {
        const bool ours = std::isfinite(t[i]), theirs = truth[i].hit();
        c.hits += theirs;
        const double difference = ours && theirs ? std::fabs(t[i] - truth[i].t) / std::fabs(truth[i].t) : 0;
        const bool agree =
            ours == theirs && !(difference > kTolerance && std::fabs(t[i] - truth[i].t) > rounding_of_origin(rays[i]));
        if (!agree) {
            ++(ours == theirs ? c.elsewhere : ours ? c.invented : c.missed);
            if (ours == theirs && oracle.within_rounding(truth[i].prim, rays[i], t[i])) {
                ++c.grazing;
                continue;
            }
        } else if (ours) {
            c.worst_t = std::max(c.worst_t, difference);
            if (prims) {
                const int prim = static_cast<int>((*prims)[i]);
                if (prim == truth[i].prim) continue;
                if (oracle.lies_at(prim, rays[i], truth[i].t, 2 * kTolerance)) {
                    ++c.ties;
                    continue;
                }
                ++c.other_prim;
            } else {
                continue;
            }
        } else {
            continue;
        }
        if (!agree && c.overruled + c.wrong() > kLookedAt) continue;  // each exact answer takes milliseconds
        const Truth exact = oracle.exact(rays[i]);
        if (!agree && exact.hit() == ours && (!ours || std::fabs(t[i] - exact.t) <= kTolerance * std::fabs(exact.t))) {
            ++c.overruled;
            continue;
        }
        if (c.first.empty()) {
            char line[256];
            std::snprintf(
                line, sizeof line, "ray %zu: t %.9g, prim %d; oracle %.9g, prim %d; all triangles in doubles %.9g, prim %d", i,
                double(t[i]), prims ? static_cast<int>((*prims)[i]) : -2, truth[i].t, truth[i].prim, exact.t, exact.prim);
            c.first = line;
        }
    }
    return c;
}

}  // namespace clarity::test
