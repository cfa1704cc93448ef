#include "tools/check/hits/built_checks.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <iterator>
#include <memory>
#include <set>

#include "base/error.hpp"
#include "moving/on_device/device_mover.hpp"
#include "plugin/capabilities.hpp"
#include "tools/check/builds/device_checks.hpp"
#include "tools/check/builds/parameter_tries.hpp"
#include "tools/check/hits/brute_force.hpp"
#include "tools/check/hits/checked_scene.hpp"
#include "tools/check/hits/judge.hpp"
#include "tools/check/hits/ray_sets.hpp"
#include "tools/check/scenes.hpp"

namespace clarity::check {
namespace {

constexpr size_t kBuiltRays = 400;  // of a set
// Processor time for the compilation of kernels that differ in a define. What is cut is said.
constexpr double kQuick_s = 6, kLong_s = 60;
constexpr unsigned kLarge = 100000, kHuge = (1u << 20) + 4099;  // above 2^16 and 75000, above 2^20

double processor_s() {
    return double(std::clock()) / CLOCKS_PER_SEC;
}

// The same with few rays, and for debugging alone.
StandInput few(StandInput input) {
    input.options.rays = kBuiltRays;
    input.options.quick = true;
    return input;
}

// A define that chooses between pieces of code is a small number. Larger ones are sizes.
constexpr rt_u32 kMostChoice = 7;

using Defines = std::map<std::string, rt_u32>;

// Adds the choices that are made otherwise than usual, such as "BVH8_SINGLE 1". Returns whether one is new.
bool add_choices(const Defines& defines, const Defines& usual, std::set<std::pair<std::string, rt_u32>>& choices) {
    const size_t known = choices.size();
    for (const auto& [name, value] : defines)
        if (const auto at = usual.find(name); value <= kMostChoice && (at == usual.end() || at->second != value))
            choices.insert({name, value});
    return choices.size() > known;
}

// Traces the mixed scene as it is built in one way after another, first where the program is there already: that of the default
// defines, with each number of lanes in turn. Next are programs of which a define chooses other code than usual: with several
// lanes and with one, because either may have code of its own. Each further set of defines is compiled with one number of
// lanes, which follows from its values: so all checks compile it once. Quick checks compile for the two least numbers, which
// take the least time.
struct Case {
    std::string what;  // "bvh2,max_leaf=1"
    BuiltAs as;
};
Outcome trace_cases(const StandInput& input, const std::vector<Case>& cases, const Step& step) {
    const double most = input.options.quick ? kQuick_s : kLong_s;
    HitStand usually(few(input));
    const Defines usual = usually.scene(step).accel()->defines;
    const size_t all_lanes = usually.options().lanes.size(),
                 lanes = input.options.quick ? std::min<size_t>(2, all_lanes) : all_lanes;
    struct Tried {
        std::string what;
        std::unique_ptr<HitStand> stand;
        Defines defines;
        size_t turn;
    };
    std::vector<Tried> left, others;
    std::set<std::pair<std::string, rt_u32>> choices;
    size_t usual_turn = 0;
    for (const Case& one : cases) {
        const auto add = [&](std::vector<Tried>& list, size_t turn) {
            auto stand = std::make_unique<HitStand>(few(input), kMixedScene, one.as);
            auto defines = stand->scene(step).accel()->defines;
            stand->take_turn(turn, step);
            list.push_back({one.what, std::move(stand), std::move(defines), turn});
        };
        const Defines defines = HitStand(few(input), kMixedScene, one.as).scene(step).accel()->defines;
        if (defines == usual) {
            add(left, usual_turn++ % all_lanes);
        } else if (add_choices(defines, usual, choices)) {
            add(left, lanes - 1);
            if (lanes > 1) add(left, 0);
        } else {
            std::string text;
            for (const auto& [name, value] : defines) text += name + "=" + std::to_string(value) + " ";
            add(others, std::hash<std::string>()(text) % lanes);
        }
    }
    std::move(others.begin(), others.end(), std::back_inserter(left));
    const std::string all = std::to_string(left.size());
    size_t traced = 0;
    double spent = 0;  // on programs of their own
    std::set<std::pair<Defines, size_t>> programs;
    for (; !left.empty() && spent < most; ++traced) {
        const double begin = processor_s();
        auto next = std::find_if(left.begin(), left.end(),
                                 [&](const Tried& t) { return t.defines == usual || programs.count({t.defines, t.turn}) > 0; });
        if (next == left.end()) next = left.begin();
        programs.insert({next->defines, next->turn});
        Outcome outcome =
            trace_sets(*next->stand, {"hits.random", "hits.instances", "hits.primitives", "hits.nested", "hits.close"},
                       "with " + next->what, step);
        if (outcome.kind == Outcome::Kind::failed) return outcome;
        if (next->defines != usual) spent += processor_s() - begin;
        left.erase(next);
    }
    return Outcome::passed("rays are right in " + (left.empty()
                                                       ? "all " + all + " cases"
                                                       : std::to_string(traced) + " of " + all + " cases: cut after " +
                                                             std::to_string(static_cast<int>(most)) + " s of processor time"));
}

Outcome parameters(const StandInput& input, const Step& step) {
    std::vector<Case> cases;
    for (const ParameterValues& params : parameter_tries(input.plugin, input.options.seed))
        cases.push_back({choice_text(input.plugin, params), {params, 0, {}, Moves::none}});
    if (cases.empty()) return Outcome::skipped("the plugin has no parameters");
    // All at their ends and in between first: they say most if time is short.
    std::rotate(cases.begin(), cases.end() - std::min<long>(4, static_cast<long>(cases.size())), cases.end());
    return trace_cases(input, cases, step);
}

Outcome packed(const StandInput& input, const Step& step) {
    if (input.layout || !input.plugin.accel->pack) return Outcome::skipped("the plugin has no `pack`");
    std::vector<Case> cases;
    for (const rt_u32 leaf : {1u, 3u, 50u})
        cases.push_back({"a packed tree of leaves of " + std::to_string(leaf), {{}, leaf, {}, Moves::none}});
    return trace_cases(input, cases, step);
}

// What is built after a refit differs in defines from what was built before: quick checks compile that for one number of lanes.
Outcome refitted(const StandInput& input, bool quick, const Step& step) {
    struct Row {
        const TestScene& scene;
        Moves moves;
        std::vector<const char*> sets;
    };
    Outcome outcome;
    for (const Row& row :
         {Row{kMixedScene, Moves::refitted, {"hits.random", "hits.instances", "hits.primitives", "hits.limits"}},
          Row{kMixedScene, Moves::rebuilt, {"hits.random", "hits.instances"}},
          Row{kRegularScene, Moves::refitted, {"hits.edges", "hits.uneven"}}}) {
        HitStand stand(input, row.scene, {{}, 0, {}, row.moves});
        const bool again = row.moves == Moves::rebuilt;
        if (again && quick && stand.scene(step).accel()->defines != HitStand(input).scene(step).accel()->defines)
            stand.take_turn(0, step);
        outcome = trace_sets(stand, row.sets, again ? "after a refit and a new build" : "after a refit", step);
        if (outcome.kind == Outcome::Kind::failed) break;
    }
    return outcome;
}

Scene nothing(uint64_t) {
    Scene scene;
    scene.materials.push_back({"default", default_material()});
    return scene;
}
std::vector<RaySet> rays_at_nothing(const BuildScene&, size_t count, uint64_t seed) {
    RayMaker make(9, seed);
    RaySet set{"hits.empty", "rays into a scene without primitives, whose world is an empty group", {}, false, ""};
    for (size_t i = 0; i < count; ++i) set.rays.push_back(make.into({"", {0, 0, 0}, 1}, i % 2 ? 3 : 0.2f));
    return {set};
}
const TestScene kEmptyScene{"an empty scene", nothing, rays_at_nothing};

// Rays at the middles of triangles anywhere, and at close faces.
std::vector<RaySet> rays_at_many(const BuildScene& scene, size_t count, uint64_t seed) {
    RayMaker make(10, seed);
    RaySet set{
        "hits.large", "rays at 100000 triangles, or as --large says, also at pairs of faces that are close", {}, false, ""};
    for (size_t i = 0; i < count && !scene.triangles.empty(); ++i) {
        const rt_packed_prim& t = scene.triangles[make.below(scene.triangles.size())];
        Point to, from = make.direction();
        for (int k = 0; k < 3; ++k) {
            to[k] = (t.a[k] + t.b[k] + t.c[k]) / 3;
            from[k] = to[k] - (i % 4 ? 0.5f : 120) * from[k];
        }
        set.rays.push_back(RayMaker::from_to(from, to));
    }
    if (count > 0) add_close_rays(scene, count / 4, make, set.rays);
    return {set};
}
const TestScene kLargeScene{"100000 triangles", [](uint64_t seed) { return large_scene(kLarge, seed); }, rays_at_many},
    kHugeScene{"more than 2^20 triangles", [](uint64_t seed) { return large_scene(kHuge, seed); }, rays_at_many, nullptr, 120};

constexpr double kDeviceLimit_s = 120;  // kernels are compiled
constexpr size_t kDeviceRays = 800;     // of a set

// The mixed scene; each mesh has a tree of its own, so that it may deform.
Scene mixed_apart() {
    Scene scene = mixed_scene();
    for (Instance& instance : scene.instances) instance.apart = true;
    return scene;
}

Pose pose_of(const Scene& scene) {
    Pose pose = pose_at_rest(scene);
    for (rt_u32 m = 0; m < scene.meshes.size(); ++m) {
        const auto first = scene.positions.begin() + 3 * size_t(scene.meshes[m].first_vertex);
        pose.meshes.push_back({m, {first, first + 3 * size_t(scene.meshes[m].vertex_count)}, {}});
    }
    return pose;
}

// A pose, its rays, and what they hit.
struct PosedRays {
    explicit PosedRays(const Scene& scene) : input("mixed", scene), pose(pose_of(scene)) {
        for (const RaySet& set : ray_sets(input.scene(), kDeviceRays, 0))
            if (set.name == std::string("hits.random") || set.name == std::string("hits.instances"))
                rays.insert(rays.end(), set.rays.begin(), set.rays.end());
        truths = BruteForce(input.scene()).trace(rays);
    }
    const BuildCase input;
    const Pose pose;
    std::vector<rt_ray> rays;
    std::vector<Truth> truths;
};

// Returns what is wrong; empty: nothing.
std::string hits_fault(CheckedScene& scene, const Prepared& moved, const PosedRays& at) {
    for (const bool any_hit : {false, true}) {
        RayQuery query;
        query.any_hit = any_hit;
        const Traced traced = scene.trace(moved, at.rays, query);
        const Faults faults = Faults::of(at.rays, at.truths, traced.hits, any_hit);
        if (!faults.wrong.empty())
            return std::string(any_hit ? "any-hit queries: " : "nearest hits: ") +
                   faults.text(at.rays, at.truths, traced.hits, 1);
        if (traced.overflows > 0) return traced.full_stack();
    }
    return {};
}

Outcome trace_moved(const rt_plugin& plugin, const rt_plugin* layout, const std::function<std::shared_ptr<Device>()>& open,
                    const Step& step) {
    if (!device_build_of(layout ? *layout : plugin).refit)
        return Outcome::skipped(std::string(layout ? "its layout" : "the plugin") + " does not offer a refit on the device");
    step("opening the device", kDeviceLimit_s);
    const std::shared_ptr<Device> device = open();
    step("building the mixed scene", kDeviceLimit_s);
    const auto rest = std::make_shared<const Scene>(mixed_apart());
    const PosedRays still(*rest), moved(rippled(*rest));
    CheckedScene scene(plugin, layout, *rest, device);
    const Variant variant = Variant::with_debug(1);
    size_t traced = 0;
    for (const BuildForm form : {BuildForm::groups, BuildForm::serial}) {
        step(std::string("preparing the scene, ") + form_text(form), kDeviceLimit_s);
        const auto prepared = scene.prepared(variant);
        DeviceMover motion(device, rest, scene.accel(), prepared->on_device, nullptr, form);
        if (motion.cannot()) return Outcome::skipped(motion.cannot().text());
        using Update = DeviceMover::Update;
        struct Turn {
            const char* what;
            const PosedRays* to;
            Update update;
        };
        std::vector<Turn> turns = {{"a refit to a moved scene", &moved, Update::refit},
                                   {"a refit back", &still, Update::refit}};
        if (motion.can_build())
            turns.insert(turns.end(), {{"a build of a moved scene", &moved, Update::build},
                                       {"a refit of what the device has built", &still, Update::refit},
                                       {"a build at rest", &still, Update::build},
                                       {"a second build of a moved scene", &moved, Update::build}});
        for (const Turn& turn : turns) {
            step(std::string("tracing after ") + turn.what + ", " + form_text(form), kDeviceLimit_s);
            const MovedOnDevice result = motion.move(turn.to->pose, turn.update);
            if (!result.on_device) return Outcome::failed(std::string(turn.what) + " failed: " + result.why);
            Prepared now = *prepared;
            now.on_device = result.on_device;
            now.accel = motion.accel();
            if (const std::string why = hits_fault(scene, now, *turn.to); !why.empty())
                return Outcome::failed(std::string("after ") + turn.what + ", " + form_text(form) + ", " + why);
            traced += turn.to->rays.size();
        }
    }
    return Outcome::passed(std::to_string(traced) + " rays, nearest and any, are right after builds and refits on " +
                           device->info().name);
}

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

std::vector<Check> built_checks(const StandInput& input) {
    std::vector<Check> checks = {
        {"hits.parameters", "rays with all parameters at the ends of their ranges, and in between",
         [=](const Step& step) { return parameters(input, step); }},
        {"hits.pack", "rays in trees of other builders, packed", [=](const Step& step) { return packed(input, step); }},
    };
    StandInput debug = input;  // other programs are those of the other checks
    debug.options.quick = true;
    const bool refits = refit_of(input.layout ? *input.layout : input.plugin).refit != nullptr;
    checks.push_back({"hits.refit", "rays in scenes that moved after the build", [=](const Step& step) {
                          return refits ? refitted(debug, input.options.quick, step)
                                        : Outcome::skipped("the plugin does not offer `refit`");
                      }});
    // Their programs are their own, because they have no instances: quick checks compile one each. A structure may have code
    // for what is large, and that of several lanes is what CPUs run.
    const auto add = [&](const TestScene& test, size_t turn) {
        const auto stand = std::make_shared<HitStand>(few(input), test);
        const RaySet set = test.rays(BuildScene(), 0, 0).front();
        checks.push_back({set.name, set.tried, [=](const Step& step) {
                              if (input.options.quick) stand->take_turn(turn, step);
                              return trace_set(*stand, set.name, step);
                          }});
    };
    add(kEmptyScene, 0);
    add(input.options.large ? kHugeScene : kLargeScene, 1);
    return checks;
}

Check device_hits_check(const rt_plugin& plugin, const rt_plugin* layout,
                        const std::function<std::shared_ptr<Device>()>& open) {
    return {"hits.device", "rays in trees that the device has built or refitted",
            [=, &plugin](const Step& step) { return trace_moved(plugin, layout, open, step); }};
}

Check own_scene_check(const StandInput& input, Scene scene, const std::vector<rt_ray>& all) {
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
    StandInput debug = input;
    debug.options.quick = true;
    return {set.name, set.tried, [=](const Step& step) {
                if (set.rays.empty()) return Outcome::skipped("there is no ray to trace" + note);
                HitStand stand(debug, *test);
                const std::vector<Truth>& truths = stand.truths(stand.set(set.name, step), step);
                Outcome outcome = trace_passes(stand, set.rays, step, [&](const Pass& pass) {
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
