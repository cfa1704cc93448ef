#include "tools/check/hits/built_checks.hpp"

#include <algorithm>
#include <array>
#include <regex>

#include "device/kernel_files.hpp"
#include "stand/ray_text.hpp"
#include "tools/check/regular_scenes.hpp"

namespace clarity::check {
namespace {

constexpr const char* kRow = "hits.row";

// A traversal's array that is a stack by its name, or by that of its size: "uint stack[BVH2_STACK]". Empty: none.
std::string stack_in(const rt_plugin& tracer) {
    static const std::regex declaration(
        R"(\b\w+\s+\w*(?:stack|Stack|todo|pending)\w*\s*\[[^\];]+\]|\b\w+\s+\w+\s*\[\w*(?:STACK|DEPTH)\w*[^\];]*\])");
    const std::string text = plugin_kernel_text(tracer, tracer.accel->traverse);
    std::smatch found;
    return std::regex_search(text, found, declaration) ? found.str() : "";
}

// Leaf tests and nodes of the sets that make traversals go through most of a tree. The rays end before their nearest hits, so
// they find nothing. Otherwise a structure with cells that do not overlap would find a hit in the first cell, and never push.
struct Effort {
    uint64_t tests[2] = {0, 0};  // nearest, any
    uint32_t most[2] = {0, 0};   // of one ray; those of nearest hits are whole for that
    uint64_t steps[2] = {0, 0};
    uint32_t most_steps[2] = {0, 0};  // of one ray
    // Cells of a space that no plane parts: one holds nearly all primitives, so what is tested says nothing about pushes.
    bool in_one_leaf() const { return steps[0] > 0 && tests[0] > kCrowded * steps[0]; }
    static constexpr uint64_t kCrowded = 64;  // primitives a node
};
// The room that a ray gets on the stack, in the order of RT_GRANT_PUSHES: as usual, never, kGranted times.
constexpr rt_u32 kGranted = 12;
enum Room { kUsual, kNone, kSome, kRooms };
struct Efforts {
    std::array<Effort, kRooms> with{};
    uint64_t asked = 0;
};

std::vector<rt_ray> for_each_room(const std::vector<rt_ray>& rays) {
    std::vector<rt_ray> all;
    for (const rt_ray& ray : rays) all.insert(all.end(), kRooms, ray);
    return all;
}

void add_efforts(HitStand& stand, const char* name, const Step& step, Efforts& efforts) {
    const Variant variant = Variant::with_debug(1);
    const RaySet& set = stand.set(name, step);
    const std::vector<Truth>& truths = stand.truths(set, step);
    CheckedScene& scene = stand.scene(step);
    std::vector<rt_ray> ended = set.rays;
    // What is not certain may lie anywhere: the plane of a triangle along the ray.
    for (size_t i = 0; i < ended.size(); ++i)
        if (const Contact* hit = truths[i].nearest_certain()) ended[i].t_max = static_cast<float>(hit->t * 0.99);
    const auto count = [&](const std::vector<rt_ray>& rays, bool any_hit) {
        step(std::string("counting the primitives that rays of ") + name + " test", compile_limit_s(stand.options()));
        return scene.count(variant, for_each_room(rays), any_hit);
    };
    for (const bool any_hit : {false, true}) {
        const Traced traced = count(ended, any_hit), whole = any_hit ? traced : count(set.rays, false);
        for (size_t i = 0; i < traced.hits.size(); ++i) {
            const rt_hit& hit = traced.hits[i];
            Effort& effort = efforts.with[i % kRooms];
            effort.tests[any_hit] += hit.leaf_tests;
            effort.steps[any_hit] += hit.steps;
            effort.most_steps[any_hit] = std::max<uint32_t>(effort.most_steps[any_hit], hit.steps);
            effort.most[any_hit] = std::max<uint32_t>(effort.most[any_hit], whole.hits[i].leaf_tests);
        }
        efforts.asked += traced.overflows;
    }
}

StandInput few_rays(StandInput input) {
    input.options.rays = 400;
    return input;
}

const TestScene kCrowd{"60000 triangles whose boxes overlap", [](uint64_t) { return crowd_scene(60000); }, crowd_ray_sets},
    kSmallCrowd{"400 triangles whose boxes overlap", [](uint64_t) { return crowd_scene(400); }, crowd_ray_sets};

// Returns the large crowd for trees, and the small one for grids and kd-trees, where each cell names each primitive of a crowd.
const TestScene& crowd_of(const StandInput& input, const Step& step) {
    constexpr uint64_t kMost = 512;  // bytes a primitive, of a structure that names it once
    HitStand small(input, kSmallCrowd);
    const AccelData& accel = *small.scene(step).accel();
    uint64_t bytes = accel.leaf_count * sizeof(rt_packed_prim);
    for (const AccelData::Slot& slot : accel.slots) bytes += slot.memory.bytes();
    return bytes > kMost * small.scene(step).build_scene().prims.size() ? kSmallCrowd : kCrowd;
}

}  // namespace

Outcome stack_check(const StandInput& input, HitStand& mixed, HitStand& regular, const Step& step) {
    struct Row {
        HitStand& stand;
        std::vector<const char*> sets;
        const char* note;
    };
    uint64_t rays = 0;
    const auto fault_of = [&](const Row& row, const std::vector<Variant>& variants) -> std::string {
        for (const char* name : row.sets)
            for (const bool any_hit : {false, true})
                for (const Variant& variant : variants) {
                    if (!variant.debug) continue;
                    const RaySet& set = row.stand.set(name, step);
                    CheckedScene& scene = row.stand.compiled(variant, step);
                    step(std::string("filling the stack with rays of ") + name + ", " + variant.text(), kTraceLimit_s);
                    const std::string full = scene.trace(variant, set.rays, any_hit).full_stack();
                    rays += set.rays.size();
                    if (!full.empty()) return std::string(name) + ", " + variant.text() + ": " + full + row.note;
                }
        return {};
    };
    for (const Row& row : {Row{mixed, {"hits.nested", "hits.random", "hits.instances", "hits.axes"}, ""},
                           Row{regular,
                               {"hits.uneven", "hits.inside", "hits.edges"},
                               ". The world of this scene is ten instances, and the trees of their meshes are deeper: the "
                               "stack must hold the deepest tree of all groups"}})
        if (const std::string why = fault_of(row, row.stand.variants(step)); !why.empty()) return Outcome::failed(why);
    // Sizes are often rounded up to a multiple of 8: among eight lengths one leaves no room.
    for (unsigned count = input.options.quick ? 25 : 18; count <= 25; ++count) {
        const TestScene scene{"a row of " + std::to_string(count) + " pairs of triangles",
                              [count](uint64_t) { return row_scene(count); }, row_ray_sets};
        StandInput debug = few_rays(input);
        debug.options.quick = true;
        HitStand stand(debug, scene);
        stand.take_turn(0, step);
        const std::string why = fault_of({stand, {kRow}, ". It is as full as the tree is deep"}, stand.variants(step));
        if (!why.empty()) return Outcome::failed(why);
        Outcome outcome = trace_set(stand, kRow, step);
        if (outcome.kind == Outcome::Kind::failed) return outcome;
    }
    return Outcome::passed("no stack was full, as far as the traversal asks RT_STACK_OK (" + std::to_string(rays) + " rays)");
}

Outcome pushes_check(const StandInput& input, const Step& step) {
    struct Row {
        const TestScene& scene;
        std::vector<const char*> sets;
        // Share of the usual tests that may be left: wide nodes test children that are leaves without a push. In cwbvh it is
        // 0.51 of the mixed scene, whose trees are small.
        double most;
        const char* where;
    };
    // After each entry that was granted, one more path down the tree may be walked. One question may be for the three entries
    // of a node of four children (bvh4), so twelve grants are up to 37 paths, and 39 of the longest are allowed. Without pushes
    // the longest path of any ray tests kLeast primitives or more. Of 4 primitives a path, 148 is the most that bvh4's nodes
    // can need, and lbvh, which they trace, tests 135. What asks for every other push alone tests 180.
    constexpr rt_u32 kLeast = 4, kLonger = 3;
    // Where few rays push, most tests are left, too: in kdtree 0.69 of those in meshes. So the longest ray must visit nearly as
    // many nodes as usual. In kdtree that is 0.44, in a traversal that does not ask 0.91.
    constexpr double kSameWay = 0.75;
    // The crowd's trees are deep everywhere. So they show a traversal that asks only while the stack is short.
    const Row rows[] = {{kMixedScene, {"hits.nested", "hits.instances", "hits.random"}, 0.75, "in the mixed scene"},
                        {kRegularScene, {"hits.uneven"}, 0.5, "in meshes with many triangles"},
                        {crowd_of(input, step), {"hits.crowd"}, 0.5, "at many triangles whose boxes overlap"}};
    const auto fault = [](const char* when, int any, const Row& row, const std::string& tested) {
        return Outcome::failed(std::string("when RT_STACK_OK refuses ") + when + ", " +
                               (any ? "any-hit queries " : "nearest hits ") + row.where + " still test " + tested +
                               ": some pushes go on without it. Ask before each push");
    };
    uint64_t asked = 0, tested = 0, usually = 0;
    uint32_t path = kLeast, longest = 0;
    std::vector<std::pair<const Row*, Effort>> with_some;
    for (const Row& row : rows) {
        HitStand stand(few_rays(input), row.scene, {{}, 0, {{"RT_STACK_GRANTED", kGranted}}, Moves::none});
        Efforts efforts;
        for (const char* name : row.sets) add_efforts(stand, name, step, efforts);
        const Effort &all = efforts.with[kUsual], &left = efforts.with[kNone];
        asked += efforts.asked;
        if (!left.in_one_leaf()) with_some.push_back({&row, efforts.with[kSome]});
        if (efforts.asked == 0 || left.in_one_leaf()) continue;
        for (const int any : {0, 1}) {
            tested += left.tests[any], usually += all.tests[any];
            path = std::max(path, left.most[any]);
            if (double(left.tests[any]) > row.most * double(all.tests[any]) + 100 &&
                left.most_steps[any] >= kSameWay * all.most_steps[any])
                return fault("every push", any, row,
                             std::to_string(left.tests[any]) + " primitives of " + std::to_string(all.tests[any]));
        }
    }
    for (const auto& [row, some] : with_some) {
        if (asked == 0) break;
        for (const int any : {0, 1}) {
            longest = std::max(longest, some.most[any]);
            if (some.most[any] > kLonger * (kGranted + 1) * path)
                return fault("all but the first 12 pushes of a ray", any, *row,
                             "up to " + std::to_string(some.most[any]) + " primitives for a ray, and one path down the tree " +
                                 std::to_string(path) + " at most");
        }
    }
    if (asked > 0)
        return Outcome::passed("every push asks RT_STACK_OK: when it refuses, " + std::to_string(tested) +
                               " primitives are tested instead of " + std::to_string(usually) +
                               "; when it grants 12, a ray tests up to " + std::to_string(longest) + ", and " +
                               std::to_string(kLonger * (kGranted + 1) * path) + " are allowed");
    const std::string stack = stack_in(input.layout ? *input.layout : input.plugin);
    if (stack.empty()) return Outcome::passed("the traversal has no stack: it never asked RT_STACK_OK, and declares none");
    return Outcome::failed(
        "the traversal has a stack, `" + stack +
        "`, but it never asked RT_STACK_OK: a stack that is too small would be written beyond its end, and nothing "
        "would say so. Ask before each push");
}

Outcome crowd_check(const StandInput& input, const Step& step) {
    HitStand crowd(few_rays(input), crowd_of(input, step));
    return trace_set(crowd, "hits.crowd", step);
}

Outcome counts_check(const StandInput& input, const Step& step) {
    // The program of hits.pushes is there already.
    const BuiltAs as{{}, 0, {{"RT_STACK_GRANTED", kGranted}}, Moves::none};
    HitStand mixed(few_rays(input), kMixedScene, as), regular(few_rays(input), kRegularScene, as);
    const Variant variant = Variant::with_debug(1);
    struct Row {
        HitStand& stand;
        const char* set;
    };
    uint64_t hits = 0, untested = 0;
    std::string first;
    for (const Row& row : {Row{mixed, "hits.random"}, Row{mixed, "hits.primitives"}, Row{regular, "hits.uneven"}}) {
        const RaySet& set = row.stand.set(row.set, step);
        CheckedScene& scene = row.stand.scene(step);
        step(std::string("counting the primitives that rays of ") + row.set + " test", compile_limit_s(input.options));
        const Traced traced = scene.count(variant, for_each_room(set.rays), false);
        for (size_t i = 0; i < set.rays.size(); ++i) {
            const rt_hit& hit = traced.hits[kRooms * i];
            if (hit.prim < 0) continue;
            ++hits;
            if (hit.leaf_tests == 0 && untested++ == 0) first = ray_text(set.rays[i]);
        }
    }
    if (untested > 0)
        return Outcome::failed(
            std::to_string(untested) + " of " + std::to_string(hits) +
            " rays hit a primitive, though the traversal tested none through the host: primitives are tested by "
            "RT_LEAF or the other functions of cl/CONTRACT.md, which also count them. The first: ray " +
            first);
    return Outcome::passed("the host tested and counted a primitive for each of " + std::to_string(hits) + " hits");
}

}  // namespace clarity::check
