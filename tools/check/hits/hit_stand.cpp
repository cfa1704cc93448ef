#include "tools/check/hits/hit_stand.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/pictures/image_io.hpp"
#include "rt_types.h"
#include "scene/vec.hpp"
#include "stand/ray_text.hpp"
#include "tools/check/hits/brute_force.hpp"
#include "tools/check/hits/checked_scene.hpp"
#include "tools/check/hits/judge.hpp"
#include "tools/check/regular_scenes.hpp"

namespace clarity::check {

const TestScene kMixedScene{"the mixed scene", mixed_scene, ray_sets, rippled},
    kRegularScene{"the scene of tessellations", regular_scene, regular_ray_sets, bent},
    kFloorScene{"the floor", [](uint64_t) { return floor_scene(); }, floor_ray_sets},
    kSizesScene{"trees of all sizes", sizes_scene, each_ray_sets};

namespace {

// A picture of the checked scene around a ray with a wrong answer: red where hits differ from the
// reference's.
struct ReportPicture {
    size_t differing = 0, pixels = 0;
};

// Odd, so that the ray itself is the one in the middle.
constexpr int kWidth = 241, kHeight = 181;
constexpr double kHalfHeight = 0.3;  // tangent of half the vertical angle of view

// One ray for each pixel, the top row first.
std::vector<rt_ray> rays_around(const rt_ray& ray) {
    const Vec along = to_vec(ray.direction), w = normalized(along);
    const Vec u = normalized(cross(w, std::fabs(w[1]) < 0.9 ? Vec{0, 1, 0} : Vec{1, 0, 0})), v = cross(u, w);
    std::vector<rt_ray> rays;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double right = kHalfHeight * (2 * (x + 0.5) - kWidth) / kHeight;
            const double above = kHalfHeight * (kHeight - 2 * (y + 0.5)) / kHeight;
            rt_ray pixel = ray;
            if (right != 0 || above != 0) {
                const Vec turned = length(along) * (w + right * u + above * v);
                for (size_t k = 0; k < 3; ++k) pixel.direction[k] = static_cast<float>(turned[k]);
            }
            rays.push_back(pixel);
        }
    return rays;
}

// Writes `path`, a PNG, whole or not at all. The camera is at the ray's origin and looks along it, with its limits. Red pixels
// have a wrong answer; the others show what the reference hits: brighter where it is nearer. Throws Error.
ReportPicture write_report_picture(const std::string& path, CheckedScene& scene, const Variant& variant, const rt_ray& ray,
                                   bool any_hit) {
    const std::vector<rt_ray> rays = rays_around(ray);
    const std::vector<Truth> truths = BruteForce(scene.build_scene()).trace(rays);
    const Traced traced = scene.trace(variant, rays, any_hit);
    double nearest = INFINITY;
    for (const Truth& truth : truths)
        if (!truth.contacts.empty()) nearest = std::min(nearest, std::max(truth.contacts.front().t, 0.0));
    ReportPicture report;
    report.pixels = rays.size();
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i < rays.size(); ++i) {
        const Fault fault = judge(rays[i], truths[i], traced.hits[i], any_hit);
        uint8_t grey = 24;  // nothing is hit
        if (!truths[i].contacts.empty()) {
            const Contact& contact = truths[i].contacts.front();
            const double near = (nearest + 1e-3) / (std::max(contact.t, 0.0) + 1e-3);  // 1 for what is nearest
            // Neighbouring primitives differ a little.
            const auto shade = static_cast<unsigned>(contact.prim) * 2654435761u >> 27;
            grey = static_cast<uint8_t>(std::clamp(70 + 130 * near + shade, 70.0, 230.0));
        }
        const bool differs = fault != Fault::none;
        report.differing += differs;
        const uint8_t pixel[4] = {differs ? uint8_t(255) : grey, differs ? uint8_t(0) : grey, differs ? uint8_t(0) : grey, 255};
        bytes.insert(bytes.end(), pixel, pixel + 4);
    }
    write_image(path, {}, ByteImage{kWidth, kHeight, SharedBytes(std::move(bytes))});
    return report;
}

constexpr size_t kRays = 2400, kQuickRays = 800;  // of a set
constexpr size_t kRaysAtOnce = 64;                // of the reference, between two steps

// Draws the scene around the first wrong ray.
std::string write_picture(const HitStand& stand, CheckedScene& scene, const Variant& variant, const std::string& name,
                          const rt_ray& ray, bool any_hit, const Step& step) {
    if (stand.options().report_folder.empty()) return {};
    const std::string path = stand.options().report_folder + "/" + stand.plugin().id + "." + name + ".png";
    step("drawing the picture of the report", compile_limit_s(stand.options()));
    try {
        const ReportPicture picture = write_report_picture(path, scene, variant, ray, any_hit);
        return "; the view along the first of them is " + path + ": " + std::to_string(picture.differing) + " of " +
               std::to_string(picture.pixels) + " pixels differ, in red";
    } catch (const Error& e) {
        return std::string("; the picture was not written: ") + e.what();
    }
}

// Where hits were, again with t_max just behind them, and with every other ray's t_min just before: the same must be found. By
// 2e-6 of the distance, which is 16 times a float's rounding, or by as much as rounding may move the hit: more than box tests
// leave out, less than what culls eagerly.
constexpr double kJust = 2e-6;
std::vector<rt_ray> rays_again(const std::vector<rt_ray>& rays, const std::vector<rt_hit>& hits,
                               const std::vector<Truth>& truths) {
    std::vector<rt_ray> again = rays;
    for (size_t i = 0; i < rays.size(); ++i) {
        const double t = hits[i].t;
        double just = INFINITY;
        for (const Contact& c : truths[i].contacts)
            if (c.prim == hits[i].prim && c.instance == hits[i].instance && std::fabs(c.t - t) <= c.t_error)
                just = std::min(just, std::max(kJust * t, c.t_error - kRelativeError * std::fabs(c.t)));
        if (hits[i].prim < 0 || !(t > 1e-30 && t < 1e30) || just > 0.1 * t) {
            again[i].t_max = -1;  // no ray
            continue;
        }
        again[i].t_max = std::min(rays[i].t_max, static_cast<float>(t + just));
        if (i % 2 == 1) again[i].t_min = std::max(rays[i].t_min, static_cast<float>(t - just));
    }
    return again;
}

// Returns what is wrong; empty: nothing.
std::string again_fault(CheckedScene& scene, const Variant& variant, const std::vector<rt_ray>& rays,
                        const std::vector<rt_hit>& hits, const std::vector<Truth>& truths, bool any_hit) {
    const std::vector<rt_ray> again = rays_again(rays, hits, truths);
    const Traced traced = scene.trace(variant, again, any_hit);
    size_t lost = 0, of = 0, first = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (again[i].t_max < 0) continue;
        ++of;
        const rt_hit& hit = traced.hits[i];
        if (any_hit ? hit.t == 0 : hit.prim >= 0 && hit.t <= again[i].t_max) continue;
        if (lost++ == 0) first = i;
    }
    if (lost == 0) return {};
    return std::to_string(lost) + " of " + std::to_string(of) +
           " hits are lost when t_max is just behind them, by as much as rounding explains, or t_min just before: a node, a "
           "cell or a "
           "leaf "
           "is left out though it begins before t_max and ends behind t_min. The first: ray " +
           ray_text(again[first]) + " -- found nothing, expected t " + std::to_string(hits[first].t) + ", prim " +
           std::to_string(hits[first].prim) + ", as with t_max " + std::to_string(rays[first].t_max);
}

}  // namespace

std::vector<Variant> HitStand::variants(const Step& step) {
    scene(step);
    const HitsOptions& options = input_.options;
    std::vector<Variant> list;
    for (const int lanes : options.lanes) list.push_back(Variant::with_debug(lanes));
    if (options.quick) return list;
    for (const int lanes : options.lanes) list.push_back(Variant::plain(lanes));
    list.push_back(Variant::plain(1));
    list.back().portable = true;
    return list;
}

CheckedScene& HitStand::scene(const Step& step) {
    if (!scene_) {
        step("opening the device", compile_limit_s(options()));
        device_ = input_.open();
        fit_lanes(input_.options, device_->info());
        step("building " + test_.what, std::max(compile_limit_s(options()), test_.limit_s));
        const Scene rest = test_.scene(input_.options.seed);
        const bool moves = as_.moves != Moves::none;
        scene_ = std::make_unique<CheckedScene>(input_.plugin, input_.layout, moves ? test_.moved(rest) : rest, device_,
                                                moves ? &rest : nullptr, as_);
    }
    return *scene_;
}

void HitStand::take_turn(size_t turn, const Step& step) {
    scene(step);
    std::vector<int>& lanes = input_.options.lanes;
    lanes = {lanes[turn % lanes.size()]};
}

CheckedScene& HitStand::compiled(const Variant& variant, const Step& step) {
    CheckedScene& at = scene(step);
    if (std::find(compiled_.begin(), compiled_.end(), variant.text()) != compiled_.end()) return at;
    step("compiling for " + variant.text(), compile_limit_s(options()));
    at.compile(variant);
    compiled_.push_back(variant.text());
    return at;
}

size_t HitStand::ray_count() const {
    if (options().rays > 0) return options().rays;
    return options().quick ? kQuickRays : kRays;
}

const std::vector<RaySet>& HitStand::sets(const Step& step) {
    if (sets_.empty()) sets_ = test_.rays(scene(step).build_scene(), ray_count(), options().seed);
    return sets_;
}

const RaySet& HitStand::set(const std::string& name, const Step& step) {
    const auto& all = sets(step);
    return *std::find_if(all.begin(), all.end(), [&](const RaySet& set) { return name == set.name; });
}

const std::vector<Truth>& HitStand::truths(const RaySet& set, const Step& step) {
    const std::string pose = as_.moves == Moves::none ? " at rest, " : " in another pose, ";
    std::vector<Truth>& known = (*input_.truths)[test_.what + pose + std::to_string(ray_count()) + " " + set.name];
    const BuildScene& at = scene(step).build_scene();
    if (known.size() == set.rays.size()) return known;
    const BruteForce force(at);
    while (known.size() < set.rays.size()) {
        step("computing what the rays hit", std::max(60.0, test_.limit_s));
        const auto begin = set.rays.begin() + static_cast<std::ptrdiff_t>(known.size());
        const auto count = static_cast<std::ptrdiff_t>(std::min(kRaysAtOnce, set.rays.size() - known.size()));
        for (Truth& truth : force.trace(std::vector<rt_ray>(begin, begin + count))) known.push_back(std::move(truth));
    }
    return known;
}

std::string write_report(const HitStand& stand, const std::string& name, const Faults& faults, const std::vector<rt_ray>& rays,
                         const std::vector<rt_hit>& hits, const std::string& what) {
    if (stand.options().report_folder.empty()) return {};
    const std::string path = stand.options().report_folder + "/" + stand.plugin().id + "." + name + ".rays";
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

Outcome trace_passes(HitStand& stand, const std::vector<rt_ray>& rays, const Step& step,
                     const std::function<Outcome(const Pass&)>& judge) {
    std::string wrong, right;
    Outcome first;
    for (const bool any_hit : {false, true})
        for (const Variant& variant : stand.variants(step)) {
            CheckedScene& scene = stand.compiled(variant, step);
            const std::string what = std::string(any_hit ? "any-hit queries" : "nearest hits") + " with " + variant.text();
            const Asked asked = asked_of(any_hit, variant.lanes);
            step("tracing " + std::to_string(rays.size()) + " rays, " + what, stand.test().limit_s, asked);
            const Traced traced = scene.trace(variant, rays, any_hit);
            Outcome outcome = judge({variant, any_hit, what, scene, traced});
            const bool failed = outcome.kind == Outcome::Kind::failed;
            if (failed && wrong.empty()) {
                first = std::move(outcome);
                first.found = what + ": " + first.found;
                first.asked = asked;
            }
            std::string& list = failed ? wrong : right;
            list += (list.empty() ? "" : "; ") + what;
        }
    if (wrong.empty())
        return Outcome::passed(std::to_string(rays.size()) + " rays, nearest and any, are right with " +
                               std::to_string(stand.variants(step).size()) + " programs");
    first.found += right.empty() ? ". With every number of lanes, nearest and any" : ". Wrong: " + wrong + ". Right: " + right;
    return first;
}

Outcome trace_set(HitStand& stand, const std::string& name, const Step& step) {
    const RaySet& set = stand.set(name, step);
    const std::vector<Truth>& truths = stand.truths(set, step);
    std::map<std::string, std::vector<rt_hit>> nearest;  // of each variant
    return trace_passes(stand, set.rays, step, [&](const Pass& pass) {
        const std::vector<rt_hit>& hits = pass.traced.hits;
        const Faults faults = Faults::of(set.rays, truths, hits, pass.any_hit);
        if (!pass.any_hit) nearest[pass.variant.text()] = hits;
        if (faults.wrong.empty()) {
            const std::string lost =
                again_fault(pass.scene, pass.variant, set.rays, nearest[pass.variant.text()], truths, pass.any_hit);
            return lost.empty() ? Outcome::passed("") : Outcome::failed(lost);
        }
        Outcome outcome = Outcome::failed(faults.text(set.rays, truths, hits, pass.variant.lanes) +
                                          (*set.hint && faults.misses() ? ". Mostly: " + std::string(set.hint) : ""));
        outcome.repeat =
            write_report(stand, name, faults, set.rays, hits, pass.what) +
            write_picture(stand, pass.scene, pass.variant, name, set.rays[faults.wrong.front().ray], pass.any_hit, step);
        return outcome;
    });
}

Outcome trace_sets(HitStand& stand, const std::vector<const char*>& names, const std::string& after, const Step& step) {
    size_t rays = 0;
    for (const char* name : names) {
        Outcome outcome = trace_set(stand, name, step);
        if (outcome.kind == Outcome::Kind::failed) {
            outcome.found = after + ", rays of " + name + ": " + outcome.found;
            return outcome;
        }
        rays += stand.set(name, step).rays.size();
    }
    return Outcome::passed(std::to_string(rays) + " rays, nearest and any, are right " + after);
}

}  // namespace clarity::check
