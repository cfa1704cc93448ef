#include "tools/check/hits/checked_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "launch/prepared.hpp"
#include "stand/multi_preparer.hpp"
#include "tools/check/builds/pack_checks.hpp"
#include "tools/check/builds/refit_run.hpp"
#include "tools/check/builds/result_checks.hpp"

namespace clarity::check {
namespace {

// Three triangles across the scene's centre, one for each axis.
rt_packed_prim trap(int i) {
    constexpr float kFar = 1e5f;
    rt_packed_prim prim{};
    const int u = (i + 1) % 3, v = (i + 2) % 3;
    prim.a[u] = prim.a[v] = -kFar;
    prim.b[u] = 3 * kFar;
    prim.b[v] = -kFar;
    prim.c[u] = -kFar;
    // The last component of c would be `prim`: the corner's third coordinate is c[2].
    prim.c[v] = 3 * kFar;
    prim.ref = RT_REF_TRIANGLE;
    prim.prim = kTrapPrim + static_cast<rt_u32>(i);
    return prim;
}

// A copy whose end lies as close to the page that nobody may touch as its elements allow. Builders get memory at multiples of
// 128 bytes, so what they fill may end up to 127 bytes before it.
GuardedBytes closer_copy(const GuardedBytes& from, size_t element) {
    size_t align = 16;
    while (align < 128 && element % (2 * align) == 0) align *= 2;
    GuardedBytes to(from.bytes(), from.name(), align, element);
    std::memcpy(to.data(), from.data(), from.bytes());
    return to;
}

}  // namespace

std::string Variant::text() const {
    return std::to_string(lanes) + (lanes == 1 ? " lane" : " lanes") + (debug ? ", debug" : "") +
           (portable ? ", portable" : "");
}
std::string Variant::options() const {
    return "--lanes " + std::to_string(lanes) + (debug ? " --debug true" : "") + (portable ? " --portable true" : "");
}

std::string Traced::full_stack() const {
    if (overflows == 0) return {};
    return "the traversal stack was full " + std::to_string(overflows) +
           " times: the define of its size is too small for the tree; without --debug it would write beyond it";
}

CheckedScene::CheckedScene(const rt_plugin& plugin, const rt_plugin* layout, Scene scene, std::shared_ptr<Device> device,
                           const Scene* rest, const BuiltAs& as)
    : scene_(std::make_shared<const Scene>(std::move(scene))), case_("mixed", *scene_), device_(std::move(device)) {
    const ParameterValues params = as.params.empty() ? default_parameters(plugin) : as.params;
    const std::unique_ptr<const BuildCase> rest_case(rest ? new BuildCase("mixed", *rest) : nullptr);
    const BuildCase& built = rest_case ? *rest_case : case_;
    const auto run_on = [&](const BuildCase& from) {
        run_ = as.packed_leaf > 0 ? from.pack(plugin, Halves(from.scene(), as.packed_leaf).topology())
                                  : from.run(plugin, params, Schedule::program);
        if (!layout || run_.why || run_.cancelled) return;
        const BuildRun tree = std::move(run_);
        run_ = from.pack(*layout, topology_of(tree.result));
    };
    run_on(built);
    if (rest && !run_.why && !run_.cancelled) {
        const rt_plugin& refits = layout ? *layout : plugin;
        RefitRun moved = run_refit(refits, layout ? default_parameters(refits) : params, run_.result, case_.scene(),
                                   std::vector<uint8_t>(case_.scene().groups.size(), 1), Schedule::program);
        if (moved.why) throw Error(Exit::failed, moved.why.text() + " (see builds.refit)").as(moved.why.failure());
        run_.result = std::move(moved.result);
        if (as.moves == Moves::rebuilt) run_on(case_);
    }
    if (run_.cancelled) run_.why = "said that it was cancelled, but nobody had cancelled it";
    if (!run_.why) run_.why = unknown_ref(case_.scene(), run_.result);  // one that is missing is worth a run
    if (run_.why)
        throw Error(Exit::failed, "the builder failed: " + run_.why.text() + " (see builds.sound)").as(run_.why.failure());

    auto accel = std::make_shared<AccelData>();
    accel->plugin = &plugin;
    accel->layout = layout ? layout : &plugin;
    accel->params = params;
    accel->scene = case_.scene();
    BuilderResult& result = run_.result;
    const rt_slot* slot = built_slots(*accel->layout).slots;
    take_result(result, *accel, [&](GuardedBytes& memory) {
        memory = closer_copy(memory, slot++->elem_bytes);
        memory.make_read_only();
        return AlignedBytes::borrow(memory.data(), memory.bytes());
    });
    leaves_ =
        GuardedBytes((result.leaf_count + kLeafPadding) * sizeof(rt_packed_prim), "the leaves", 128, sizeof(rt_packed_prim));
    auto* leaves = static_cast<rt_packed_prim*>(leaves_.data());
    const auto* refs = static_cast<const rt_u32*>(result.refs.data());
    const BuildScene& build = case_.scene();
    for (uint64_t i = 0; i < result.leaf_count; ++i) leaves[i] = packed_of(build, refs[i]);
    for (uint64_t i = 0; i < kLeafPadding; ++i) leaves[result.leaf_count + i] = trap(static_cast<int>(i % 3));
    leaves_.make_read_only();
    accel->leaves = AlignedBytes::borrow(leaves_.data(), leaves_.bytes());
    for (const auto& [name, value] : as.defines) accel->defines[name] = value;
    accel_ = std::move(accel);
    queries_ = std::make_unique<RayQueries>(device_);
}

std::shared_ptr<const Prepared> CheckedScene::prepared(const Variant& variant) {
    std::shared_ptr<const Prepared>& known = prepared_[variant.text()];
    if (known) return known;
    Settings settings;
    settings.lanes = variant.lanes;
    settings.debug = variant.debug;
    settings.portable = variant.portable;
    Progress progress;
    return known = prepare_queries(*device_, scene_, accel_, settings, progress);
}

void CheckedScene::compile(const Variant& variant) {
    // A ray of no extent: drivers compile a kernel when it first runs.
    trace(variant, {rt_ray{{0, 0, 0}, 1, {0, 0, 1}, -1}}, false);
}

Traced CheckedScene::trace(const Variant& variant, const std::vector<rt_ray>& rays, bool any_hit) {
    RayQuery query;
    query.any_hit = any_hit;
    return trace(*prepared(variant), rays, query);
}

Traced CheckedScene::count(const Variant& variant, const std::vector<rt_ray>& rays, bool any_hit) {
    RayQuery query;
    query.any_hit = any_hit;
    query.count = true;
    return trace(*prepared(variant), rays, query);
}

AllHits CheckedScene::trace_all(const Variant& variant, const std::vector<rt_ray>& rays, bool count_only) {
    Progress progress;
    return queries_->trace_all(*prepared(variant), rays, {count_only, true}, progress);
}

Traced CheckedScene::trace(const Prepared& in, const std::vector<rt_ray>& rays, RayQuery query) {
    Traced traced;
    query.quiet = true;  // the checks say it
    queries_->trace(in, RayBlocks(rays, in.layout.lanes), query, &traced.hits);
    traced.overflows = queries_->overflows();
    return traced;
}

}  // namespace clarity::check
