// hit_stand.hpp -- a structure over one scene, the rays that are sent into it, and what they hit: shared by the checks of hits.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/check/hits/brute_force.hpp"
#include "tools/check/hits/checked_scene.hpp"
#include "tools/check/hits/hits_checks.hpp"
#include "tools/check/hits/judge.hpp"
#include "tools/check/hits/ray_sets.hpp"

namespace clarity::check {

// Processor time of one program, which takes 2 to 7 s. Quick checks of a kernel without end must not take minutes.
inline double compile_limit_s(const HitsOptions& options) {
    return options.quick ? 40 : 120;
}
constexpr double kTraceLimit_s = 10;  // some thousand rays take milliseconds; a loop without end takes for ever

// A scene, and the rays for it.
struct TestScene {
    std::string what;  // "the mixed scene"
    std::function<Scene(uint64_t seed)> scene;
    std::function<std::vector<RaySet>(const BuildScene& scene, size_t count, uint64_t seed)> rays;
    Scene (*moved)(Scene scene) = nullptr;  // in another pose
    double limit_s = kTraceLimit_s;         // for a build, for a set of rays, and for what 64 of them hit
};
extern const TestScene kMixedScene, kRegularScene, kFloorScene, kSizesScene;

using OpenDevice = std::function<std::shared_ptr<Device>()>;
// What rays hit, by the scene, its pose, the number of rays and the set: it does not depend on how a structure is built.
using KnownTruths = std::map<std::string, std::vector<Truth>>;

// What a stand is for. Plugin and layout must outlive it.
struct StandInput {
    const rt_plugin& plugin;
    const rt_plugin* layout;  // what traces the tree if the plugin builds a topology, otherwise nullptr
    OpenDevice open;          // on first use
    HitsOptions options;
    std::shared_ptr<KnownTruths> truths = std::make_shared<KnownTruths>();  // shared by all copies
};

// Used from one thread.
class HitStand {
 public:
    explicit HitStand(StandInput input, const TestScene& test = kMixedScene, BuiltAs as = {})
        : input_(std::move(input)), test_(test), as_(std::move(as)) {}

    const HitsOptions& options() const { return input_.options; }
    const rt_plugin& plugin() const { return input_.plugin; }
    const TestScene& test() const { return test_; }
    std::vector<Variant> variants(const Step& step);
    CheckedScene& scene(const Step& step);
    // From now on with one of the numbers of lanes; turn: any number.
    void take_turn(size_t turn, const Step& step);
    CheckedScene& compiled(const Variant& variant, const Step& step);
    const std::vector<RaySet>& sets(const Step& step);
    const RaySet& set(const std::string& name, const Step& step);
    const std::vector<Truth>& truths(const RaySet& set, const Step& step);

 private:
    size_t ray_count() const;  // of a set

    StandInput input_;
    const TestScene& test_;
    const BuiltAs as_;
    std::shared_ptr<Device> device_;
    std::unique_ptr<CheckedScene> scene_;
    std::vector<std::string> compiled_;
    std::vector<RaySet> sets_;
};

// One way in which rays were traced.
struct Pass {
    const Variant& variant;
    bool any_hit;
    std::string what;  // "any-hit queries with 4 lanes, debug"
    CheckedScene& scene;
    const Traced& traced;
};
// Traces rays with every variant, nearest and any. judge: says what is wrong with a pass. Returns what is wrong with the first
// of those that failed, and which of them failed.
Outcome trace_passes(HitStand& stand, const std::vector<rt_ray>& rays, const Step& step,
                     const std::function<Outcome(const Pass&)>& judge);
// Traces a set with every variant, nearest and any, and judges all answers.
Outcome trace_set(HitStand& stand, const std::string& name, const Step& step);
// Sets one after the other until one fails. after: "after a refit", for the message.
Outcome trace_sets(HitStand& stand, const std::vector<const char*>& names, const std::string& after, const Step& step);

// Writes the wrong rays, for `clarity trace`, with what was found as comments; if the user wants a report. Returns where.
std::string write_report(const HitStand& stand, const std::string& name, const Faults& faults, const std::vector<rt_ray>& rays,
                         const std::vector<rt_hit>& hits, const std::string& what);

}  // namespace clarity::check
