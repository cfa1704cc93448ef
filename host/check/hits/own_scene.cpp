#include "check/hits/own_scene.hpp"

#include <algorithm>
#include <cmath>

namespace clarity::check {
namespace {

constexpr double kPrimsPerSecond = 1e5;  // that the slowest structure builds, and of the reference for 64 rays

// The reference knows what finite rays with a direction hit.
bool is_traceable(const rt_ray& ray) {
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(ray.origin[k]) || !std::isfinite(ray.direction[k])) return false;
        squared += double(ray.direction[k]) * double(ray.direction[k]);
    }
    return squared > 0 && !std::isnan(ray.t_min) && !std::isnan(ray.t_max);
}

}  // namespace

Check own_scene_check(const BenchInput& input, Scene scene, const std::vector<rt_ray>& all) {
    RaySet set{"hits.own", "your rays in your scene", {}};
    std::copy_if(all.begin(), all.end(), std::back_inserter(set.rays), is_traceable);
    const size_t left_out = all.size() - set.rays.size();
    const std::string note =
        left_out == 0 ? "" : "; " + std::to_string(left_out) + " rays were left out that are not finite or have no direction";
    const double limit_s = 10 + double(scene.placed_triangle_count()) / kPrimsPerSecond;
    const auto shared = std::make_shared<const Scene>(std::move(scene));
    const auto test = std::make_shared<const TestScene>(
        TestScene{"the scene", [=](uint64_t) { return *shared; },
                  [=](const BuildScene&, size_t, uint64_t) { return std::vector<RaySet>{set}; }, nullptr, limit_s});
    BenchInput debug = input;
    debug.options.quick = true;
    return {set.name, set.tried, [=](const Step& step) {
                if (set.rays.empty()) return Outcome::skipped("there is no ray to trace" + note);
                Bench bench(debug, *test);
                const std::vector<Truth>& truths = bench.truths(bench.set(set.name, step), step);
                Outcome outcome = trace_passes(bench, set.rays, step, [&](const Pass& pass) {
                    const Traced& traced = pass.traced;
                    const Faults faults = Faults::of(set.rays, truths, traced.hits, pass.any_hit);
                    if (!faults.wrong.empty())
                        return Outcome::failed(faults.text(set.rays, truths, traced.hits, pass.variant.lanes));
                    const std::string full = traced.full_stack();
                    return full.empty() ? Outcome::passed("") : Outcome::failed(full);
                });
                outcome.found += note;
                return outcome;
            }};
}

}  // namespace clarity::check
