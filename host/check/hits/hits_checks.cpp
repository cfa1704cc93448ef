#include "check/hits/hits_checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "check/hits/brute_force.hpp"
#include "check/hits/checked_scene.hpp"
#include "check/hits/device_hits.hpp"
#include "check/hits/judge.hpp"
#include "check/hits/plane_checks.hpp"
#include "check/hits/ray_sets.hpp"
#include "check/hits/report_picture.hpp"
#include "check/oclgrind.hpp"
#include "check/scenes.hpp"
#include "plugin/extensions.hpp"
#include "render/tracers/rays/ray_text.hpp"

namespace clarity::check {
namespace {

constexpr double kCompileLimit_s = 120;
constexpr double kTraceLimit_s = 10;              // some thousand rays take milliseconds; a loop without end takes for ever
constexpr size_t kRays = 2400, kQuickRays = 800;  // of a set

// Everything that the checks of one structure share.
class Bench {
 public:
    // refits: the structure is built for the mixed scene at rest, and refitted to a moved one.
    Bench(const rt_plugin& plugin, const rt_plugin* layout, std::function<std::shared_ptr<Device>()> open,
          const HitsOptions& options, bool refits = false)
        : plugin_(plugin), layout_(layout), options_(options), open_(std::move(open)), refits_(refits) {}

    const HitsOptions& options() const { return options_; }
    std::vector<Variant> variants(const Step& step) {
        scene(step);
        std::vector<Variant> list;
        for (const int lanes : options_.lanes) list.push_back({lanes, true, false});
        if (options_.quick) return list;
        for (const int lanes : options_.lanes) list.push_back({lanes, false, false});
        list.push_back({1, false, true});
        return list;
    }
    CheckedScene& scene(const Step& step) {
        if (!scene_) {
            step("opening the device", kCompileLimit_s);
            device_ = open_();
            fit_lanes(options_, device_->info());
            step("building the mixed scene", kCompileLimit_s);
            const Scene rest = mixed_scene();
            scene_ = refits_ ? std::make_unique<CheckedScene>(plugin_, layout_, rippled(rest), device_, &rest)
                             : std::make_unique<CheckedScene>(plugin_, layout_, rest, device_);
        }
        return *scene_;
    }
    CheckedScene& compiled(const Variant& variant, const Step& step) {
        CheckedScene& at = scene(step);
        if (std::find(compiled_.begin(), compiled_.end(), variant.text()) != compiled_.end()) return at;
        step("compiling for " + variant.text(), kCompileLimit_s);
        at.compile(variant);
        compiled_.push_back(variant.text());
        return at;
    }
    const std::vector<RaySet>& sets(const Step& step) {
        if (sets_.empty())
            sets_ = ray_sets(scene(step).build_scene(), options_.rays > 0 ? options_.rays
                                                        : options_.quick  ? kQuickRays
                                                                          : kRays);
        return sets_;
    }
    const RaySet& set(const std::string& name, const Step& step) {
        const auto& all = sets(step);
        return *std::find_if(all.begin(), all.end(), [&](const RaySet& set) { return name == set.name; });
    }
    const std::vector<Truth>& truths(const RaySet& set, const Step& step) {
        std::vector<Truth>& known = truths_[set.name];
        if (known.empty()) known = BruteForce(scene(step).build_scene()).trace(set.rays);
        return known;
    }
    const rt_plugin& plugin() const { return plugin_; }

 private:
    const rt_plugin& plugin_;
    const rt_plugin* const layout_;
    HitsOptions options_;
    const std::function<std::shared_ptr<Device>()> open_;
    const bool refits_;
    std::shared_ptr<Device> device_;
    std::unique_ptr<CheckedScene> scene_;
    std::vector<std::string> compiled_;
    std::vector<RaySet> sets_;
    std::map<std::string, std::vector<Truth>> truths_;
};

// Writes the wrong rays, for `clarity trace`, with what was found and expected as comments.
std::string write_report(const Bench& bench, const std::string& name, const Faults& faults, const std::vector<rt_ray>& rays,
                         const std::vector<rt_hit>& hits, const std::string& what) {
    if (bench.options().report_folder.empty()) return {};
    const std::string path = bench.options().report_folder + "/" + bench.plugin().id + "." + name + ".rays";
    std::string text = "# " + what + "\n";
    for (const Faults::One& one : faults.wrong)
        text += ray_text(rays[one.ray]) + "  # found t " + std::to_string(hits[one.ray].t) + " prim " +
                std::to_string(hits[one.ray].prim) + "\n";
    try {
        write_text_file(path, text);
    } catch (const Error& e) {
        return std::string("the report was not written: ") + e.what();
    }
    return "the rays are in " + path;
}

// Draws the scene around the first wrong ray.
std::string write_picture(const Bench& bench, CheckedScene& scene, const Variant& variant, const std::string& name,
                          const rt_ray& ray, bool any_hit, const Step& step) {
    if (bench.options().report_folder.empty()) return {};
    const std::string path = bench.options().report_folder + "/" + bench.plugin().id + "." + name + ".png";
    step("drawing the picture of the report", kCompileLimit_s);
    try {
        const ReportPicture picture = write_report_picture(path, scene, variant, ray, any_hit);
        return "; the view along the first of them is " + path + ": " + std::to_string(picture.differing) + " of " +
               std::to_string(picture.pixels) + " pixels differ, in red";
    } catch (const Error& e) {
        return std::string("; the picture was not written: ") + e.what();
    }
}

Outcome compile(Bench& bench, const Step& step) {
    for (const Variant& variant : bench.variants(step)) try {
            bench.compiled(variant, step);
        } catch (const Error& e) {
            std::string log = e.details().substr(0, 400);
            std::replace(log.begin(), log.end(), '\n', ' ');
            return Outcome::failed("for " + variant.text() + ": " + e.what() + (log.empty() ? "" : ": " + log));
        }
    return Outcome::passed(std::to_string(bench.variants(step).size()) + " programs compiled");
}

// Traces a set with every variant, nearest and any, and judges all answers.
Outcome trace_set(Bench& bench, const std::string& name, const Step& step) {
    const RaySet& set = bench.set(name, step);
    step("computing what these rays hit", 60);
    const std::vector<Truth>& truths = bench.truths(set, step);
    std::vector<std::string> wrong_variants, right_variants;
    Outcome first;
    for (const bool any_hit : {false, true})
        for (const Variant& variant : bench.variants(step)) {
            CheckedScene& scene = bench.compiled(variant, step);
            const std::string what = std::string(any_hit ? "any-hit queries" : "nearest hits") + " with " + variant.text();
            step("tracing " + std::to_string(set.rays.size()) + " rays, " + what, kTraceLimit_s);
            const Traced traced = scene.trace(variant, set.rays, any_hit);
            const Faults faults = Faults::of(set.rays, truths, traced.hits, any_hit);
            if (faults.wrong.empty()) {
                right_variants.push_back(what);
                continue;
            }
            if (wrong_variants.empty()) {
                first = Outcome::failed(what + ": " + faults.text(set.rays, truths, traced.hits, variant.lanes));
                first.repeat = write_report(bench, name, faults, set.rays, traced.hits, what) +
                               write_picture(bench, scene, variant, name, set.rays[faults.wrong.front().ray], any_hit, step);
            }
            wrong_variants.push_back(what);
        }
    if (wrong_variants.empty())
        return Outcome::passed(std::to_string(set.rays.size()) + " rays, nearest and any, are right with " +
                               std::to_string(bench.variants(step).size()) + " programs");
    if (right_variants.empty()) {
        first.found += ". With every number of lanes, nearest and any";
        return first;
    }
    first.found += ". Wrong: ";
    for (size_t i = 0; i < wrong_variants.size(); ++i) first.found += (i ? "; " : "") + wrong_variants[i];
    first.found += ". Right: ";
    for (size_t i = 0; i < right_variants.size(); ++i) first.found += (i ? "; " : "") + right_variants[i];
    return first;
}

// The same rays on a structure that was refitted.
Outcome refit(Bench& bench, const Step& step) {
    size_t rays = 0;
    for (const char* name : {"hits.random", "hits.instances"}) {
        Outcome outcome = trace_set(bench, name, step);
        if (outcome.kind == Outcome::Kind::failed) {
            outcome.found = "after a refit, rays of " + std::string(name) + ": " + outcome.found;
            return outcome;
        }
        rays += bench.set(name, step).rays.size();
    }
    return Outcome::passed(std::to_string(rays) + " rays, nearest and any, are right after a refit");
}

Outcome strange_set(Bench& bench, const std::string& name, const Step& step) {
    const RaySet& set = bench.set(name, step);
    const auto is_strange = [](size_t i) { return i % 5 == 2; };
    const BruteForce force(bench.scene(step).build_scene());
    std::vector<Truth> truths;  // strange rays hit nothing
    for (size_t i = 0; i < set.rays.size(); ++i) truths.push_back(is_strange(i) ? Truth() : force.trace(set.rays[i]));
    for (const bool any_hit : {false, true})
        for (const Variant& variant : bench.variants(step)) {
            CheckedScene& scene = bench.compiled(variant, step);
            const std::string what = std::string(any_hit ? "any-hit queries" : "nearest hits") + " with " + variant.text();
            step("tracing rays that are no numbers, " + what, kTraceLimit_s);
            Traced traced = scene.trace(variant, set.rays, any_hit);
            for (size_t i = 0; i < set.rays.size(); ++i) {
                if (!is_strange(i)) continue;
                rt_hit& hit = traced.hits[i];
                if (std::isnan(hit.t) || hit.prim < -1 || hit.prim >= static_cast<rt_i32>(kTrapPrim))
                    return Outcome::failed(what + ": the ray " + ray_text(set.rays[i]) + " has an answer that is none: t " +
                                           std::to_string(hit.t) + ", prim " + std::to_string(hit.prim));
                hit.t = INFINITY, hit.prim = -1;  // no answer of a strange ray is wrong: it counts as a miss
            }
            const Faults faults = Faults::of(set.rays, truths, traced.hits, any_hit);
            if (faults.wrong.empty()) continue;
            Outcome outcome = Outcome::failed(what +
                                              ", beside rays that are no numbers (`--only hits.random` tells whether it "
                                              "is right without them): " +
                                              faults.text(set.rays, truths, traced.hits, variant.lanes));
            outcome.repeat = write_report(bench, name, faults, set.rays, traced.hits, what);
            return outcome;
        }
    return Outcome::passed("all have an answer, and sound rays beside them are right");
}

Outcome stack(Bench& bench, const Step& step) {
    uint64_t rays = 0;
    for (const char* name : {"hits.nested", "hits.random", "hits.instances", "hits.axes"})
        for (const bool any_hit : {false, true})
            for (const Variant& variant : bench.variants(step)) {
                if (!variant.debug) continue;
                const RaySet& set = bench.set(name, step);
                CheckedScene& scene = bench.compiled(variant, step);
                step("filling the stack, " + variant.text(), kTraceLimit_s);
                const Traced traced = scene.trace(variant, set.rays, any_hit);
                rays += set.rays.size();
                if (traced.overflows > 0)
                    return Outcome::failed(
                        "the traversal stack was full " + std::to_string(traced.overflows) + " times (" + name + ", " +
                        variant.text() +
                        "): the define of its size is too small for the tree; without --debug it would write beyond it");
            }
    return Outcome::passed("no stack was full, as far as the traversal asks RT_STACK_OK (" + std::to_string(rays) + " rays)");
}

Outcome accesses(Bench& bench, const Step& step) {
    const Variant variant{bench.options().lanes.front(), false, false};
    size_t rays = 0;
    for (const RaySet& set : bench.sets(step))
        for (const bool any_hit : {false, true}) {
            CheckedScene& scene = bench.compiled(variant, step);
            step(std::string("tracing ") + set.name + " on a simulated device", kCompileLimit_s);
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
    const auto bench = std::make_shared<Bench>(plugin, layout, open, few);
    return {{kAccessCheck, kAccessTried, [=](const Step& step) { return accesses(*bench, step); }}};
}

std::vector<Check> hits_checks(const rt_plugin& plugin, const rt_plugin* layout,
                               const std::function<std::shared_ptr<Device>()>& open, const HitsOptions& options) {
    const auto bench = std::make_shared<Bench>(plugin, layout, open, options);
    std::vector<Check> checks = {{"hits.kernels", "the kernels compile for each number of lanes",
                                  [=](const Step& step) { return compile(*bench, step); }},
                                 {"hits.stack", "the traversal stack holds the tree, with --debug",
                                  [=](const Step& step) { return stack(*bench, step); }}};
    for (const RaySet& set : ray_sets_by_name()) {
        const std::string name = set.name;
        if (set.strange)
            checks.push_back({name, set.tried, [=](const Step& step) { return strange_set(*bench, name, step); }});
        else
            checks.push_back({name, set.tried, [=](const Step& step) { return trace_set(*bench, name, step); }});
    }
    checks.push_back(planes_check(plugin, layout, open, options));
    HitsOptions one = options;  // the programs are those of the other checks, so one of them says enough
    one.quick = true;
    one.lanes.resize(1);
    const auto refitted = std::make_shared<Bench>(plugin, layout, open, one, true);
    const bool refits = refit_of(layout ? *layout : plugin).refit != nullptr;
    checks.push_back({"hits.refit", "rays in a scene that moved after the build", [=](const Step& step) {
                          return refits ? refit(*refitted, step) : Outcome::skipped("the plugin does not offer `refit`");
                      }});
    checks.push_back(device_hits_check(plugin, layout, open));
    return checks;
}

}  // namespace clarity::check
