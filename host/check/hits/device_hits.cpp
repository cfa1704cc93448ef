#include "check/hits/device_hits.hpp"

#include "base/error.hpp"
#include "check/builds/device_checks.hpp"
#include "check/hits/brute_force.hpp"
#include "check/hits/checked_scene.hpp"
#include "check/hits/judge.hpp"
#include "check/hits/ray_sets.hpp"
#include "check/scenes.hpp"
#include "plugin/extensions.hpp"
#include "render/moving/on_device/device_mover.hpp"

namespace clarity::check {
namespace {

constexpr double kDeviceLimit_s = 120;  // kernels are compiled
constexpr size_t kDeviceRays = 800;     // of a set

// The mixed scene; each mesh has a tree of its own, so that it may deform.
Scene mixed_apart() {
    Scene scene = mixed_scene();
    for (Instance& instance : scene.instances) instance.apart = true;
    return scene;
}

Pose pose_of(const Scene& scene) {
    Pose pose;
    for (const Instance& instance : scene.instances)
        pose.instances.push_back({instance.mesh, instance.world_from_object, instance.visible});
    pose.cameras = scene.cameras;
    pose.lights = scene.lights;
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
    const Variant variant{1, true, false};
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

}  // namespace

Check device_hits_check(const rt_plugin& plugin, const rt_plugin* layout,
                        const std::function<std::shared_ptr<Device>()>& open) {
    return {"hits.device", "rays in trees that the device has built or refitted",
            [=, &plugin](const Step& step) { return trace_moved(plugin, layout, open, step); }};
}

}  // namespace clarity::check
