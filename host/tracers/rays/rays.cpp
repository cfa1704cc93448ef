// rays.cpp -- ray queries as tracers: how their kernels are tried in a worker.
#include <cmath>
#include <random>

#include "tracers/rays/ray_kernels.hpp"
#include "tracers/rays/ray_queries.hpp"
#include "tracers/smoke.hpp"

namespace clarity {
namespace {

// Rays from around and inside the scene, some of them beside each other, some along an axis.
std::vector<rt_ray> trial_rays() {
    constexpr size_t kCount = 1000;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> among(-1, 1);
    std::vector<rt_ray> rays(kCount);
    for (size_t i = 0; i < kCount; ++i) {
        rt_ray& ray = rays[i];
        float length = 0;
        for (int axis = 0; axis < 3; ++axis) {
            ray.origin[axis] = (i % 2 ? 7.0f : 1.5f) * among(random);
            ray.direction[axis] = i % 2 ? 2 * among(random) - ray.origin[axis] : among(random);
            length += ray.direction[axis] * ray.direction[axis];
        }
        for (float& d : ray.direction) d /= std::sqrt(std::max(length, 1e-6f));
        if (i % 20 == 0)
            for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = axis == int(i / 20 % 3) ? 1.0f : 0.0f;
        if (i % 7 == 0 && i > 0) ray.origin[0] = rays[i - 1].origin[0];
        ray.t_min = 1e-4f;
        ray.t_max = i % 5 ? INFINITY : 3.0f;
    }
    return rays;
}

void smoke_rays(const Smoke& smoke, bool counted) {
    const double limit_s = compile_first(smoke, counted ? counted_rays() : plain_rays());
    const RayBlocks rays(trial_rays(), smoke.prepared.layout.lanes);
    const std::string what = "traced " + std::to_string(rays.ray_count()) + " rays of a query";
    RayQueries queries(smoke.device);
    for (const bool any_hit : {false, true}) {
        constexpr int kMostRuns = 24;  // the autotuner has tried each variant before
        RayQuery query;
        query.any_hit = any_hit;
        query.count = counted;
        for (int run = 0; run < kMostRuns; ++run) {
            smoke.say_step("they " + what, limit_s);
            std::vector<rt_hit> hits;
            queries.trace(smoke.prepared, rays, query, &hits);
            expect_room_on_stacks(queries.overflows(), what);
            if (queries.tuning().settled) break;
        }
    }
}

void smoke_all_hits(const Smoke& smoke) {
    const double limit_s = compile_first(smoke, all_hits());
    const std::vector<rt_ray> rays = trial_rays();
    const std::string what = "traced " + std::to_string(rays.size()) + " rays for all their hits";
    smoke.say_step("they " + what, limit_s);
    RayQueries queries(smoke.device);
    Progress never_cancelled;
    queries.trace_all(smoke.prepared, rays, {}, never_cancelled);
    expect_room_on_stacks(queries.overflows(), what);
}

}  // namespace

const Tracer& rays_tracer() {
    static const Tracer tracer = tracer_with("rays", [](const Smoke& smoke) { smoke_rays(smoke, false); });
    return tracer;
}

const Tracer& counted_rays_tracer() {
    static const Tracer tracer = tracer_with("counted_rays", [](const Smoke& smoke) { smoke_rays(smoke, true); });
    return tracer;
}

const Tracer& all_hits_tracer() {
    static const Tracer tracer = tracer_with("all_hits", smoke_all_hits);
    return tracer;
}

}  // namespace clarity
