#include "api/ray_arrays.hpp"

#include <cmath>
#include <cstring>
#include <string>

#include "base/error.hpp"

namespace clarity::api {
namespace {

// Arrays need not be aligned.
template <class Number>
double number_at(const void* array, int64_t offset) {
    Number number;
    std::memcpy(&number, static_cast<const char*>(array) + offset, sizeof number);
    return number;
}

template <class Number>
rt_ray ray_at(const clarity_rays& rays, int64_t i, const std::array<double, 3>& origin) {
    rt_ray ray{};
    for (int k = 0; k < 3; ++k) {
        const double at = number_at<Number>(rays.origins, i * rays.origin_steps[0] + k * rays.origin_steps[1]);
        ray.origin[k] = static_cast<float>(at - origin[k]);
        ray.direction[k] =
            static_cast<float>(number_at<Number>(rays.directions, i * rays.direction_steps[0] + k * rays.direction_steps[1]));
    }
    ray.t_min = rays.t_min ? static_cast<float>(number_at<Number>(rays.t_min, i * rays.t_min_step)) : 0;
    ray.t_max = rays.t_max ? static_cast<float>(number_at<Number>(rays.t_max, i * rays.t_max_step)) : INFINITY;
    return ray;
}

}  // namespace

void check_rays(const clarity_rays& rays) {
    if (rays.type != CLARITY_FLOAT32 && rays.type != CLARITY_FLOAT64)
        throw Error(Exit::usage, "the rays have the unknown type " + std::to_string(rays.type) +
                                     ": CLARITY_FLOAT32 and CLARITY_FLOAT64 are known");
    if (rays.mask > RT_SEEN_BY_ALL)
        throw Error(Exit::usage, "the rays have the mask " + std::to_string(rays.mask) + ": expected 0 to 255");
    if (rays.packed) return;
    if (rays.count > 0 && (!rays.origins || !rays.directions))
        throw Error(Exit::usage, "the rays have no origins or no directions: the pointer is null");
}

void read_rays(const clarity_rays& rays, size_t first, size_t count, const std::array<double, 3>& origin, rt_ray* to) {
    for (size_t i = 0; i < count; ++i) {
        const auto at = static_cast<int64_t>(first + i);
        to[i] = rays.type == CLARITY_FLOAT64 ? ray_at<double>(rays, at, origin) : ray_at<float>(rays, at, origin);
    }
}

void append_hits(const AllHits& hits, HitArrays& to) {
    const auto begin = static_cast<int64_t>(to.t.size());
    for (size_t ray = 0; ray + 1 < hits.first.size(); ++ray) {
        to.ray.insert(to.ray.end(), hits.count(ray), static_cast<int64_t>(to.first.size() - 1));
        to.first.push_back(begin + static_cast<int64_t>(hits.first[ray + 1]));
    }
    for (const rt_hit& hit : hits.hits) {
        to.t.push_back(hit.t);
        to.prim.push_back(hit.prim);
        to.instance.push_back(hit.instance);
        to.uv.insert(to.uv.end(), {hit.u, hit.v});
    }
}

void give_hits(std::unique_ptr<HitArrays> hits, clarity_all_hits& to) {
    const HitArrays& from = *hits;
    to.count = from.t.size();
    to.first = from.first.data();
    to.ray = from.ray.data();
    to.t = from.t.data();
    to.prim = from.prim.data();
    to.instance = from.instance.data();
    to.uv = from.uv.data();
    to.owner = hits.release();
}

void take_back_hits(clarity_all_hits& hits) {
    delete static_cast<HitArrays*>(hits.owner);
    clarity_all_hits none{};
    none.struct_bytes = hits.struct_bytes, none.unused = hits.unused;
    hits = none;
}

}  // namespace clarity::api
