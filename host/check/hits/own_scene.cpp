#include "check/hits/own_scene.hpp"

#include <algorithm>
#include <cmath>

#include "check/hits/brute_force.hpp"
#include "check/hits/checked_scene.hpp"
#include "check/hits/judge.hpp"

namespace clarity::check {
namespace {

constexpr double kOwnCompile_s = 120;
constexpr double kPrimsPerSecond = 1e5;  // that the slowest structure builds, and of the reference for 64 rays
constexpr size_t kRaysAtOnce = 64;       // of the reference, between two steps

// The reference knows what finite rays with a direction hit.
bool is_traceable(const rt_ray& ray) {
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(ray.origin[k]) || !std::isfinite(ray.direction[k])) return false;
        squared += double(ray.direction[k]) * double(ray.direction[k]);
    }
    return squared > 0 && !std::isnan(ray.t_min) && !std::isnan(ray.t_max);
}

Outcome own_scene(const rt_plugin& plugin, const rt_plugin* layout, const std::function<std::shared_ptr<Device>()>& open,
                  HitsOptions options, const Scene& scene, const std::vector<rt_ray>& all, const Step& step) {
    std::vector<rt_ray> rays;
    std::copy_if(all.begin(), all.end(), std::back_inserter(rays), is_traceable);
    const std::string left_out = rays.size() == all.size() ? ""
                                                           : "; " + std::to_string(all.size() - rays.size()) +
                                                                 " rays were left out that are not finite or have no direction";
    if (rays.empty()) return Outcome::skipped("there is no ray to trace" + left_out);
    const double many_s = 10 + double(scene.placed_triangle_count()) / kPrimsPerSecond;
    step("opening the device", kOwnCompile_s);
    const std::shared_ptr<Device> device = open();
    fit_lanes(options, device->info());
    step("building the scene", many_s);
    CheckedScene checked(plugin, layout, scene, device);

    const BruteForce force(checked.build_scene());
    std::vector<Truth> truths;
    while (truths.size() < rays.size()) {
        step("computing what the rays hit", many_s);
        const auto begin = rays.begin() + static_cast<std::ptrdiff_t>(truths.size());
        const auto count = static_cast<std::ptrdiff_t>(std::min(kRaysAtOnce, rays.size() - truths.size()));
        for (Truth& truth : force.trace(std::vector<rt_ray>(begin, begin + count))) truths.push_back(std::move(truth));
    }

    std::vector<std::string> wrong, right;
    std::string first;
    for (const bool any_hit : {false, true})
        for (const int lanes : options.lanes) {
            const Variant variant{lanes, true, false};
            const std::string what = std::string(any_hit ? "any-hit queries" : "nearest hits") + " with " + variant.text();
            step("compiling for " + variant.text(), kOwnCompile_s);
            checked.compile(variant);
            step("tracing " + std::to_string(rays.size()) + " rays, " + what, many_s);
            const Traced traced = checked.trace(variant, rays, any_hit);
            const Faults faults = Faults::of(rays, truths, traced.hits, any_hit);
            std::string fault = faults.wrong.empty() ? "" : faults.text(rays, truths, traced.hits, variant.lanes);
            if (fault.empty() && traced.overflows > 0)
                fault = "the traversal stack was full " + std::to_string(traced.overflows) +
                        " times: the define of its size is too small for the tree";
            (fault.empty() ? right : wrong).push_back(what);
            if (!fault.empty() && first.empty()) first = what + ": " + fault;
        }
    if (wrong.empty())
        return Outcome::passed(std::to_string(rays.size()) + " rays, nearest and any, are right with " +
                               std::to_string(options.lanes.size()) + " programs" + left_out);
    if (right.empty()) return Outcome::failed(first + ". With every number of lanes, nearest and any" + left_out);
    std::string text = first + ". Right: ";
    for (size_t i = 0; i < right.size(); ++i) text += (i ? "; " : "") + right[i];
    return Outcome::failed(text + left_out);
}

}  // namespace

Check own_scene_check(const rt_plugin& plugin, const rt_plugin* layout, const std::function<std::shared_ptr<Device>()>& open,
                      const HitsOptions& options, Scene scene, std::vector<rt_ray> rays) {
    const auto shared_scene = std::make_shared<const Scene>(std::move(scene));
    const auto shared_rays = std::make_shared<const std::vector<rt_ray>>(std::move(rays));
    return {"hits.own", "your rays in your scene", [=, &plugin](const Step& step) {
                return own_scene(plugin, layout, open, options, *shared_scene, *shared_rays, step);
            }};
}

}  // namespace clarity::check
