#include "check/hits/hits_checks.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "check/hits/all_hits_checks.hpp"
#include "check/hits/bench.hpp"
#include "check/hits/built_checks.hpp"
#include "check/hits/device_hits.hpp"
#include "check/hits/plane_checks.hpp"
#include "check/hits/reserved_names.hpp"
#include "check/hits/stack_checks.hpp"
#include "check/oclgrind.hpp"
#include "render/tracers/rays/ray_text.hpp"

namespace clarity::check {
namespace {

Outcome compile(Bench& bench, const rt_plugin& tracer, const Step& step) {
    if (const Problem why = reserved_name_fault(tracer)) return Outcome::failed(why.text());
    for (const Variant& variant : bench.variants(step)) try {
            bench.compiled(variant, step);
        } catch (const Error& e) {
            std::string log = e.details().substr(0, 400);
            std::replace(log.begin(), log.end(), '\n', ' ');
            return Outcome::failed("for " + variant.text() + ": " + e.what() + (log.empty() ? "" : ": " + log));
        }
    return Outcome::passed(std::to_string(bench.variants(step).size()) + " programs compiled");
}

Outcome strange_set(Bench& bench, const std::string& name, const Step& step) {
    const RaySet& set = bench.set(name, step);
    const auto is_strange = [](size_t i) { return i % 5 == 2; };
    const BruteForce force(bench.scene(step).build_scene());
    std::vector<Truth> truths;  // strange rays hit nothing
    for (size_t i = 0; i < set.rays.size(); ++i) truths.push_back(is_strange(i) ? Truth() : force.trace(set.rays[i]));
    return trace_passes(bench, set.rays, step, [&](const Pass& pass) {
        std::vector<rt_hit> hits = pass.traced.hits;
        for (size_t i = 0; i < hits.size(); ++i) {
            if (!is_strange(i)) continue;
            rt_hit& hit = hits[i];
            if (std::isnan(hit.t) || hit.prim < -1 || hit.prim >= static_cast<rt_i32>(kTrapPrim))
                return Outcome::failed("the ray " + ray_text(set.rays[i]) + " has an answer that is none: t " +
                                       std::to_string(hit.t) + ", prim " + std::to_string(hit.prim));
            hit.t = INFINITY, hit.prim = -1;  // no answer of a strange ray is wrong: it counts as a miss
        }
        const Faults faults = Faults::of(set.rays, truths, hits, pass.any_hit);
        if (faults.wrong.empty()) return Outcome::passed("");
        Outcome outcome =
            Outcome::failed("beside rays that are no numbers (`--only hits.random` tells whether it is right without them): " +
                            faults.text(set.rays, truths, hits, pass.variant.lanes));
        outcome.repeat = write_report(bench, name, faults, set.rays, hits, pass.what);
        return outcome;
    });
}

Outcome accesses(Bench& bench, const Step& step) {
    const Variant variant{bench.options().lanes.front(), false, false};
    size_t rays = 0;
    for (const RaySet& set : bench.sets(step))
        for (const bool any_hit : {false, true}) {
            CheckedScene& scene = bench.compiled(variant, step);
            step(std::string("tracing ") + set.name + " on a simulated device", compile_limit_s(bench.options()));
            scene.trace(variant, set.rays, any_hit);
            rays += set.rays.size();
        }
    return Outcome::passed("every access of " + std::to_string(rays) + " rays is within its buffer");
}

}  // namespace

void fit_lanes(HitsOptions& options, const DeviceInfo& info) {
    if (!info.traces_packets() && !options.lanes_are_named) options.lanes = {1};  // as resolve_packet()
}

std::vector<Check> access_checks(const rt_plugin& plugin, const rt_plugin* layout,
                                 const std::function<std::shared_ptr<Device>()>& open, const HitsOptions& options) {
    HitsOptions few = options;
    few.rays = 16;
    few.lanes.resize(1);
    const auto bench = std::make_shared<Bench>(BenchInput{plugin, layout, open, few});
    return {{kAccessCheck, kAccessTried, [=](const Step& step) { return accesses(*bench, step); }}};
}

std::vector<Check> hits_checks(const rt_plugin& plugin, const rt_plugin* layout,
                               const std::function<std::shared_ptr<Device>()>& open_device, const HitsOptions& options) {
    const auto opened = std::make_shared<std::shared_ptr<Device>>();
    const OpenDevice open = [opened, open_device] {
        if (!*opened) *opened = open_device();
        return *opened;
    };
    const BenchInput input{plugin, layout, open, options};
    const rt_plugin& tracer = layout ? *layout : plugin;
    const auto bench = std::make_shared<Bench>(input), regular = std::make_shared<Bench>(input, kRegularScene),
               floor = std::make_shared<Bench>(input, kFloorScene), sizes = std::make_shared<Bench>(input, kSizesScene);
    std::vector<Check> checks = {
        {"hits.kernels", "the kernels compile for each number of lanes, and define no name of the host",
         [=, &tracer](const Step& step) { return compile(*bench, tracer, step); }},
        {"hits.stack", "the traversal stack holds the tree, with --debug",
         [=](const Step& step) { return stack_check(input, *bench, *regular, step); }},
        {"hits.pushes", "the traversal asks RT_STACK_OK before each push",
         [=](const Step& step) { return pushes_check(input, step); }},
        {"hits.counts", "primitives are tested by the host", [=](const Step& step) { return counts_check(input, step); }}};
    for (const auto& of : {sizes, bench, floor, regular})
        for (const RaySet& set : of->test().rays(BuildScene(), 0, 0)) {
            const std::string name = set.name;
            if (set.strange)
                checks.push_back({name, set.tried, [=](const Step& step) { return strange_set(*of, name, step); }});
            else
                checks.push_back({name, set.tried, [=](const Step& step) { return trace_set(*of, name, step); }});
        }
    checks.push_back(planes_check(input));
    const RaySet crowd = crowd_ray_sets(BuildScene(), 0).front();
    checks.push_back({crowd.name, crowd.tried, [=](const Step& step) { return crowd_check(input, step); }});
    for (Check& check : built_checks(input)) checks.push_back(std::move(check));
    checks.push_back(all_hits_check(input));
    checks.push_back(device_hits_check(plugin, layout, open));
    return checks;
}

}  // namespace clarity::check
