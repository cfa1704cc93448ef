// ray_arrays.hpp -- between arrays of the caller and rays of queries.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "api/clarity.h"
#include "rt_types.h"
#include "tracers/rays/ray_queries.hpp"

namespace clarity::api {

// Throws Error(usage) for what cannot be read.
void check_rays(const clarity_rays& rays);
// Writes the rays [first, first + count) to `to`. origin: of the scene, subtracted in double precision.
void read_rays(const clarity_rays& rays, size_t first, size_t count, const std::array<double, 3>& origin, rt_ray* to);

// All hits, field by field.
struct HitArrays {
    std::vector<int64_t> first{0}, ray;
    std::vector<float> t, uv;
    std::vector<int32_t> prim, instance;
};
// Appends those of more rays.
void append_hits(const AllHits& hits, HitArrays& to);
// Between the caller's struct and its owner.
void give_hits(std::unique_ptr<HitArrays> hits, clarity_all_hits& to);
void take_back_hits(clarity_all_hits& hits);

}  // namespace clarity::api
