#include "tools/check/builds/device_checks.hpp"

#include <algorithm>
#include <cfloat>

#include "base/error.hpp"
#include "plugin/capabilities.hpp"
#include "tools/check/builds/device_run.hpp"
#include "tools/check/builds/refit_checks.hpp"
#include "tools/check/builds/refit_run.hpp"
#include "tools/check/builds/result_checks.hpp"
#include "tools/check/scenes.hpp"

namespace clarity::check {
namespace {

constexpr double kPlanLimit_s = 120;  // kernels are compiled
constexpr double kRunLimit_s = 20;
constexpr unsigned kChain = 200;    // primitives of the deepest tree that layouts get: below RT_TOPOLOGY_DEPTH
constexpr size_t kLookedAt = 1000;  // primitives: a look at all volumes of more would last too long

// Triangles that lie apart, in a pose: boxes and, for the look at volumes, corners.
class Posed {
 public:
    Posed(unsigned count, const Movement& movement) : case_(movement.name, movement.move(sparse_scene(count))) {
        for (rt_prim prim : case_.scene().prims) {
            for (int k = 0; k < 3; ++k) {
                prim.lo[k] = std::clamp(prim.lo[k], -FLT_MAX, FLT_MAX);
                prim.hi[k] = std::clamp(prim.hi[k], -FLT_MAX, FLT_MAX);
            }
            prims_.push_back(prim);
        }
    }
    const std::string& name() const { return case_.name(); }
    const BuildScene& scene() const { return case_.scene(); }
    const std::vector<rt_prim>& prims() const { return prims_; }
    // The primitives in this order.
    std::vector<rt_prim> prims(const std::vector<rt_u32>& order) const {
        std::vector<rt_prim> ordered;
        for (const rt_u32 number : order) ordered.push_back(prims_[number]);
        return ordered;
    }

 private:
    BuildCase case_;
    std::vector<rt_prim> prims_;
};

std::vector<Posed> poses_of(unsigned count) {
    std::vector<Posed> poses;
    for (const Movement& movement : movements()) poses.emplace_back(count, movement);
    return poses;
}

class DeviceCheck {
 public:
    DeviceCheck(const rt_plugin& plugin, std::function<std::shared_ptr<Device>()> open, bool quick)
        : plugin_(plugin), build_(device_build_of(plugin)), open_(std::move(open)), quick_(quick) {}

    Outcome run(const Step& step) {
        if (!build_.topology && !build_.pack && !build_.refit)
            return Outcome::skipped("the plugin does not offer `device_build`");
        step("opening the device", kPlanLimit_s);
        const std::shared_ptr<Device> device = open_();
        Problem why;
        try {
            for (const BuildForm form : {BuildForm::groups, BuildForm::serial}) {
                const BuildKernels kernels(device, form);
                const Step in_form([&](const std::string& what, double limit_s, Asked asked) {
                    step(what + ", " + form_text(form), limit_s, asked);
                });
                if (build_.topology) why = topology_fault(kernels, in_form);
                if (!why && build_.pack) why = pack_fault(kernels, in_form);
                if (!why && build_.refit) why = refit_fault(kernels, in_form);
                if (why) return Outcome::failed(std::string(form_text(form)), why);
            }
        } catch (const cl::Error& e) {
            return Outcome::failed("the device failed: " + std::string(e.what()) + ", OpenCL error " + std::to_string(e.err()));
        }
        return Outcome::passed(std::to_string(runs_) + " trees, built or refitted on " + device->info().name +
                               ", hold every primitive");
    }

 private:
    // One plan for all poses of so many triangles.
    Problem topology_fault(const BuildKernels& kernels, const Step& step) {
        std::vector<unsigned> counts = {0, 1, 2, 3, 9, 300, 5000};
        if (!quick_) counts.push_back(40000);
        for (const unsigned count : counts) {
            const std::string triangles = std::to_string(count) + " triangles";
            step("planning a tree over " + triangles, kPlanLimit_s);
            TopologyRun builder(kernels, plugin_, count);
            std::vector<rt_u32> first, leaves;
            const std::vector<Posed> poses = poses_of(count);
            const auto build = [&](const Posed& pose) -> Problem {
                step("building a tree over " + triangles + " " + pose.name(), kRunLimit_s);
                ++runs_;
                Problem why = builder.run(pose.prims(), leaves);
                return why ? Problem("for " + triangles + " " + pose.name() + " the builder " + why.text()) : Problem();
            };
            for (const Posed& pose : poses) {
                if (const Problem why = build(pose)) return why;
                if (first.empty()) first = leaves;
            }
            if (const Problem why = build(poses.front())) return why;
            if (leaves != first)
                return "for " + triangles + " the builder makes another tree when its plan runs again over the same boxes: a " +
                       "step depends on what an earlier run left in a buffer, or on the order of work-groups";
        }
        return {};
    }

    // Packs trees of either kind, and refits them to the next pose.
    Problem pack_fault(const BuildKernels& kernels, const Step& step) {
        std::vector<unsigned> counts = {1, 2, 3, 9, 150, 400};
        counts.push_back(quick_ ? 9000 : 40000);
        for (const unsigned count : counts) {
            const std::vector<Posed> poses = poses_of(count);
            for (const auto make : {halved_tree, chain_tree}) {
                if (make == chain_tree && count > kChain) continue;
                const std::string what =
                    std::to_string(count) + " triangles in a " + (make == chain_tree ? "chain" : "balanced tree") + ", ";
                step("planning nodes for " + what, kPlanLimit_s);
                LayoutRun layout(kernels, plugin_, count, make(poses.front().prims()).depth);
                for (size_t p = 0; p < poses.size(); ++p) {
                    const Posed &pose = poses[p], &next = poses[(p + 1) % poses.size()];
                    step("packing " + what + pose.name(), kRunLimit_s);
                    std::vector<rt_u32> leaves;
                    Problem why = layout.pack(pose.prims(), make(pose.prims()), leaves);
                    if (!why) why = look(layout, pose);
                    if (why) return "for " + what + pose.name() + " the layout " + why.text();
                    step("refitting " + what + next.name(), kRunLimit_s);
                    why = layout.refit(next.prims(leaves));
                    if (!why) why = look(layout, next);
                    if (why) return "a refit of " + what + "from " + pose.name() + " to " + next.name() + " " + why.text();
                    runs_ += 2;
                }
            }
        }
        return {};
    }
    Problem look(const LayoutRun& layout, const Posed& pose) const {
        if (!plugin_.accel->levels || pose.prims().size() > kLookedAt) return {};
        BuilderResult result = layout.result();
        Problem why = loose_bounds(plugin_, pose.scene(), result);
        return why ? Problem("left out what it must hold: " + why.text()) : Problem();
    }

    // Refits trees that the host has built, group by group.
    Problem refit_fault(const BuildKernels& kernels, const Step& step) {
        std::vector<NamedScene> scenes = small_scenes();
        scenes.push_back({"sparse", sparse_scene(300)});
        for (const NamedScene& scene : scenes) {
            std::vector<PosedCosts> poses;
            for (const Movement& movement : movements()) {
                if (scene.name == "mixed" && quick_ && std::string(movement.name) != "as a wave") continue;
                const std::string what = "scene `" + scene.name + "`, " + movement.name;
                step("refitting " + what, kPlanLimit_s);
                const BuildCase rest(scene.name, scene.scene), moved(scene.name, movement.move(scene.scene));
                if (moved.scene().prims.size() != rest.scene().prims.size()) continue;  // flattened in another way
                PosedCosts costs{movement.name, {}, {}};
                if (const Problem why = refit_fault(kernels, rest, moved, costs)) return what + ": " + why.text();
                if (!movement.is_flat && !costs.surfaces.empty()) poses.push_back(std::move(costs));
                ++runs_;
            }
            if (poses.empty()) continue;
            const BuildCase rest(scene.name, scene.scene);
            if (const Problem why = cost_fault(rest.scene(), poses)) return "scene `" + scene.name + "`: " + why.text();
        }
        return {};
    }
    // costs: receives those of each group, and surfaces if the plugin shows its levels.
    Problem refit_fault(const BuildKernels& kernels, const BuildCase& rest, const BuildCase& moved, PosedCosts& costs) {
        BuildRun built = rest.run(plugin_, default_parameters(plugin_), Schedule::program);
        if (built.why) return built.why;
        const auto* const refs = static_cast<const rt_u32*>(built.result.refs.data());
        std::map<rt_u32, rt_prim> by_ref;
        for (const rt_prim& prim : moved.scene().prims) by_ref[prim.ref] = prim;
        uint64_t positions = 0;
        for (rt_u32 g = 0; g < built.result.roots.size(); ++g) {
            Problem why;
            LayoutRun layout(kernels, plugin_, built.result, g, why);
            if (!why && layout.first_leaf() + layout.count() > built.result.leaf_count)
                why = "`ranges` names positions in leaf order that there are not";
            if (why) return "group " + std::to_string(g) + ": " + why.text();
            positions += layout.count();
            costs.costs.push_back(-1);
            if (layout.count() == 0) continue;
            std::vector<rt_prim> prims;
            for (uint64_t i = 0; i < layout.count(); ++i) prims.push_back(by_ref.at(refs[layout.first_leaf() + i]));
            why = layout.refit(prims);
            if (why) return "the refit of group " + std::to_string(g) + " " + why.text();
            costs.costs.back() = layout.cost();
            built.result.slots = std::move(layout.result().slots);
        }
        if (positions != built.result.leaf_count)
            return "`ranges` gives the groups " + std::to_string(positions) + " positions together, of " +
                   std::to_string(built.result.leaf_count);
        if (!plugin_.accel->levels) return {};
        Problem why = loose_bounds(plugin_, moved.scene(), built.result);
        if (!why) costs.surfaces = relative_surfaces(plugin_, built.result);
        return why ? Problem("after the refit " + why.text()) : Problem();
    }

    const rt_plugin& plugin_;
    const rt_device_build build_;
    const std::function<std::shared_ptr<Device>()> open_;
    const bool quick_;
    unsigned runs_ = 0;
};

}  // namespace

const char* form_text(BuildForm form) {
    return form == BuildForm::serial ? "with one work-item a group" : "in groups of 256 work-items";
}

Check device_check(const rt_plugin& plugin, const std::function<std::shared_ptr<Device>()>& open, bool quick) {
    const auto check = std::make_shared<DeviceCheck>(plugin, open, quick);
    return {"builds.device", "trees that the device builds or refits hold every primitive, and write nothing else",
            [=](const Step& step) { return check->run(step); }};
}

}  // namespace clarity::check
