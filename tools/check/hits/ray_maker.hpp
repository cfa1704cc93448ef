// ray_maker.hpp -- rays by chance, for checks.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "rt_types.h"
#include "tools/check/scenes.hpp"
#include "tools/check/seed.hpp"

namespace clarity::check {

constexpr float kFar = std::numeric_limits<float>::infinity();

class RayMaker {
 public:
    RayMaker(unsigned own, uint64_t seed) : random_(random_of(own, seed)) {}
    float any() { return std::uniform_real_distribution<float>(0, 1)(random_); }
    size_t below(size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random_); }
    Point direction() {
        Point d;
        float length = 0;
        do {
            for (float& c : d) c = std::normal_distribution<float>()(random_);
            length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        } while (length < 1e-3f);
        for (float& c : d) c /= length;
        return d;
    }
    Point within(const Region& region, float share = 1) {
        Point p = region.center;
        for (float& c : p) c += share * region.radius * (2 * any() - 1);
        return p;
    }
    static rt_ray from_to(const Point& from, const Point& to) {
        rt_ray ray{{from[0], from[1], from[2]}, 0, {to[0] - from[0], to[1] - from[1], to[2] - from[2]}, kFar};
        const float length = std::sqrt(ray.direction[0] * ray.direction[0] + ray.direction[1] * ray.direction[1] +
                                       ray.direction[2] * ray.direction[2]);
        if (length > 0)
            for (float& d : ray.direction) d /= length;
        return ray;
    }
    // A ray from `away` radii outside to a point of the region.
    rt_ray into(const Region& region, float away) { return along(direction(), region, away); }
    rt_ray along(const Point& d, const Region& region, float away) {
        const Point to = within(region, 0.8f);
        Point from = to;
        for (int k = 0; k < 3; ++k) from[k] -= away * region.radius * d[k];
        return from_to(from, to);
    }

 private:
    std::mt19937 random_;
};

}  // namespace clarity::check
