// broken.cpp -- a small binary BVH with one defect: own_defect.hpp. `clarity check` must find each, and none in the plugin with
// the defect `none`.
#include <algorithm>
#include <atomic>
#include <cfloat>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "own_defect.hpp"
#include "rt_device.hpp"
// needs the types of rt_types.h, so it must follow the headers above:
#include "broken_types.h"

namespace {

bool is(const char* defect) {
    return own_defect("") == defect;
}

// Defects of the traversal, which are macros there.
struct Macro {
    const char *defect, *macro;
};
constexpr Macro kMacros[] = {{"octant", "BROKEN_OCTANT"},
                             {"any_forgets_t_max", "BROKEN_ANY_FORGETS_T_MAX"},
                             {"any_returns_early", "BROKEN_ANY_RETURNS_EARLY"},
                             {"culls_eagerly", "BROKEN_CULLS_EAGERLY"},
                             {"axis", "BROKEN_AXIS"},
                             {"planes", "BROKEN_PLANES"},
                             {"first_lane", "BROKEN_FIRST_LANE"},
                             {"lanes_8", "BROKEN_LANES_8"},
                             {"never_incoherent", "BROKEN_NEVER_INCOHERENT"},
                             {"device_loop", "BROKEN_DEVICE_LOOP"},
                             {"ignores_transform", "BROKEN_IGNORES_TRANSFORM"},
                             {"writes_t", "BROKEN_WRITES_T"},
                             {"stops_at_first_leaf", "BROKEN_STOPS_AT_FIRST_LEAF"},
                             {"all_stops", "BROKEN_ALL_STOPS"},
                             {"reads_beyond_slot", "BROKEN_READS_BEYOND_SLOT"},
                             {"no_slack", "BROKEN_SLABS"},
                             {"strict_slabs", "BROKEN_STRICT"},
                             {"divides", "BROKEN_DIVIDES"},
                             {"sign_of_d", "BROKEN_SIGN_OF_D"},
                             {"rounds_boxes", "BROKEN_ROUNDS_BOXES"},
                             {"culls_closely", "BROKEN_CULLS_CLOSELY"},
                             {"culls_leaves", "BROKEN_CULLS_LEAVES"},
                             {"not_far", "BROKEN_NOT_FAR"},
                             {"ends_at_a_million", "BROKEN_ENDS_AT_A_MILLION"},
                             {"forgets_deferred", "BROKEN_FORGETS_DEFERRED"},
                             {"not_inside", "BROKEN_NOT_INSIDE"},
                             {"gives_up", "BROKEN_GIVES_UP"},
                             {"gives_up_late", "BROKEN_GIVES_UP_LATE"},
                             {"lanes_16_any", "BROKEN_LANES_16_ANY"},
                             {"unasked", "BROKEN_UNASKED"},
                             {"unasked_any", "BROKEN_UNASKED_ANY"},
                             {"unasked_mesh", "BROKEN_UNASKED_MESH"},
                             {"unasked_deep", "BROKEN_UNASKED_DEEP"},
                             {"unasked_from_8", "BROKEN_UNASKED_FROM_8"},
                             {"unasked_odd", "BROKEN_UNASKED_ODD"},
                             {"own_test", "BROKEN_OWN_TEST"},
                             {"cut_positions", "BROKEN_CUT_POSITIONS"},
                             {"reads_past_empty", "BROKEN_READS_PAST_EMPTY"}};
constexpr const char* kWithSlabs[] = {"strict_slabs", "divides", "sign_of_d", "rounds_boxes"};  // need BROKEN_SLABS, too

constexpr const char* kWays[] = {"first", "second", "third", nullptr};
constexpr rt_param kParams[] = {rt::int_param("max_leaf", "Leaf size", "primitives in a leaf, at most", 1, 8, 3),
                                rt::enum_param("way", "Way", "chooses nothing, but with the defect `wrong_choice`", kWays, 0)};

bool has_refitted = false;  // state that a plugin must not keep

struct Box {
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    void add(const rt_prim& prim) {
        for (int k = 0; k < 3; ++k) {
            lo[k] = std::fmin(lo[k], prim.lo[k]);
            hi[k] = std::fmax(hi[k], prim.hi[k]);
        }
    }
};

class Builder {
 public:
    explicit Builder(const rt_build_input* input) : input_(*input), most_(rt_u32(input->params[0])) {}

    rt_u32 group(rt_u32 g) {
        const rt_group& range = input_.groups[g];
        std::vector<rt_u32> order(range.count);
        for (rt_u32 i = 0; i < range.count; ++i) order[i] = range.first + i;
        if (is("dropped") && range.count > 20) order.pop_back();
        if (is("dropped_at_limit") && most_ == 1 && range.count > 20) order.pop_back();
        if (is("build_after_refit") && has_refitted && range.count > 20) order.resize(order.size() / 2);
        if (is("half")) order.resize((order.size() + 1) / 2);
        const rt_u32 root = add_nodes(1);
        split(root, order.data(), rt_u32(order.size()), 1);
        if (g == 0) depth_of_world = depth;
        for (size_t i = root; i < nodes.size() && is("last_short"); ++i)  // the last primitive is in no leaf's range
            if (nodes[i].count > 1 && nodes[i].count != BROKEN_EMPTY && nodes[i].first + nodes[i].count == refs.size())
                --nodes[i].count;
        return root;
    }

    std::vector<broken_node> nodes;
    std::vector<rt_u32> refs;
    rt_u32 depth = 1, depth_of_world = 1;

 private:
    rt_u32 add_nodes(rt_u32 count) {
        nodes.resize(nodes.size() + count);
        return rt_u32(nodes.size() - count);
    }
    void split(rt_u32 at, rt_u32* order, rt_u32 count, rt_u32 level) {
        Box box;
        for (rt_u32 i = 0; i < count; ++i) {
            rt_prim prim = input_.prims[order[i]];
            for (int k = 0; k < 3 && is("cuts_needles"); ++k)  // what is longer than 3 counts as 3 long
                prim.hi[k] = std::fmin(prim.hi[k], prim.lo[k] + 3);
            box.add(prim);
        }
        depth = std::max(depth, level);
        if (is("ulp_short"))
            for (float& hi : box.hi) hi = std::nextafter(hi, -INFINITY);
        if (is("nan_planes") && level == 4) box.hi[1] = NAN;
        for (int k = 0; k < 3; ++k) {
            nodes[at].box[k] = count ? box.lo[k] : FLT_MAX;
            nodes[at].box[3 + k] = count ? box.hi[k] : FLT_MAX;
        }
        // The median of the longest axis.
        int axis = 0;
        for (int k = 1; k < 3; ++k)
            if (box.hi[k] - box.lo[k] > box.hi[axis] - box.lo[axis]) axis = k;
        const auto middle = [&](rt_u32 i) { return 0.5f * input_.prims[i].lo[axis] + 0.5f * input_.prims[i].hi[axis]; };
        const bool one_centre = is("counts_of_8_bits") &&
                                std::all_of(order, order + count, [&](rt_u32 i) { return middle(i) == middle(order[0]); });
        if (count <= most_ || one_centre) {
            nodes[at].first = rt_u32(refs.size());
            nodes[at].count = count == 0 ? BROKEN_EMPTY : count > 255 ? count & 255u : count;
            for (rt_u32 i = 0; i < count; ++i) refs.push_back(input_.prims[order[i]].ref);
            return;
        }
        std::sort(order, order + count, [&](rt_u32 x, rt_u32 y) {
            const float p = middle(x), q = middle(y);
            return p < q || (p == q && x < y);
        });
        if (is("random_when_large") && count > 65536)
            std::swap(order[0], order[count / 2 + std::random_device()() % (count / 2)]);
        const rt_u32 first = add_nodes(2);
        nodes[at].first = first;
        nodes[at].count = 0;
        split(first, order, count / 2, level + 1);
        split(first + 1, order + count / 2, count - count / 2, level + 1);
    }
    const rt_build_input& input_;
    const rt_u32 most_;
};

volatile int sink = 0;
volatile bool never = false;
int recurse(int n) {
    if (never) return 0;
    char room[4096];
    std::memset(room, n, sizeof room);
    sink += room[n & 1023];
    return recurse(n + 1) + room[7];
}

// What ends a process, or keeps it from ending.
void misbehave() {
    if (is("segfault")) *reinterpret_cast<volatile int*>(16) = 1;
    if (is("aborts")) std::abort();
    if (is("exits")) std::exit(0);
    if (is("throws_in_thread")) std::thread([] { throw std::runtime_error("thrown in a thread of the plugin"); }).join();
    if (is("stack_overflow")) sink += recurse(0);
    if (is("build_loop"))
        for (;;) sink = sink + 1;
    if (is("memory_hog"))
        for (;;) std::memset(new char[64 << 20], 1, 64 << 20);
    if (is("leak")) sink += int(reinterpret_cast<uintptr_t>(std::malloc(500)) & 1);
    if (is("thread_leak"))
        std::thread([] {
            for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
        }).detach();
}

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    misbehave();
    if (is("writes_input")) const_cast<rt_prim*>(input->prims)[0].lo[0] = 0;
    Builder builder(input);
    std::vector<rt_u32> roots;
    for (rt_u32 g = 0; g < input->group_count; ++g) {
        roots.push_back(builder.group(g));
        if (host->progress(host->ctx, float(g + 1) / float(input->group_count)) == 0 && !is("ignores_cancel"))
            return RT_CANCELLED;
    }
    std::vector<broken_node>& nodes = builder.nodes;
    if (is("roots_rotated")) std::rotate(roots.begin(), roots.begin() + 1, roots.end());
    if (is("root_of_another") && roots.size() > 2) std::swap(roots[1], roots[2]);
    if (is("refs_of_another_group") && roots.size() > 1)  // the second tree's leaves name the world's primitives
        for (size_t i = roots[1]; i < nodes.size(); ++i)
            if (nodes[i].count != 0 && nodes[i].count != BROKEN_EMPTY) nodes[i].first = nodes[i].first % 64;
    for (broken_node& node : nodes) {
        const bool leaf = node.count != 0 && node.count != BROKEN_EMPTY;
        if (is("leaf_reaches_too_far") && leaf && node.first + node.count == builder.refs.size()) node.count += 3;
        if (is("leaf_far_outside") && leaf && node.first % 7 == 3) node.first += 8000;  // within the guard of 1 MiB
        if (is("leaf_very_far") && leaf && node.first % 7 == 3) node.first += 9000000;  // 432 MB
        if (is("node_far_outside") && node.count == 0 && node.first % 7 == 3) node.first += 100000;
        if (is("leaf_off_by_three") && leaf) node.first = node.first >= 3 ? node.first - 3 : 0;
    }
    const size_t more = is("wasteful") ? 40 * nodes.size() : 0;
    auto* memory = rt::alloc<broken_node>(out, 0, nodes.size() + more);
    std::memcpy(memory, nodes.data(), nodes.size() * sizeof nodes[0]);
    if (is("overrun")) memory[nodes.size()] = memory[0];
    if (is("overrun_far")) memory[nodes.size() + 100] = memory[0];
    if (is("underrun")) memory[-1] = memory[0];
    rt_u32* refs = rt::leaves(out, builder.refs.size());
    std::memcpy(refs, builder.refs.data(), builder.refs.size() * sizeof refs[0]);
    if (is("race")) {
        // All bodies share a counter: the last to come wins.
        rt_u32 shared = 0;
        rt::parallel_for(host, 1000, [&](rt_u32 i) { shared = shared * 31 + i; });
        memory[0].box[5] += float(shared % 1000) * 1e-3f;
    }
    if (is("keeps_state")) {
        static std::atomic<int> builds{0};
        memory[0].box[5] += 1e-3f * float(builds++ % 100);
    }
    if (is("writes_later"))
        std::thread([memory] {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            memory[0].box[5] = 0;
        }).detach();
    for (rt_u32 g = 0; g < input->group_count; ++g)
        if (!(is("no_root") && g == 1)) rt::root(out, g, roots[g]);
    for (const Macro& macro : kMacros)
        if (is(macro.defect)) rt::define(out, macro.macro, 1);
    for (const char* defect : kWithSlabs)
        if (is(defect)) rt::define(out, "BROKEN_SLABS", 1);
    if (is("wrong_at_most") && input->params[0] == 8) rt::define(out, "BROKEN_SKIPS_EIGHTH", 1);
    if (is("wrong_choice")) rt::define(out, "BROKEN_CHOICE", input->params[1] == 1);
    if (is("wrong_when_large") && builder.refs.size() > 75000) rt::define(out, "BROKEN_CHOICE", 1);
    if (is("defines_lanes")) rt::define(out, "RT_LANES", 4);
    if (is("reads_beyond_slot")) rt::define(out, "BROKEN_NODES", rt_u32(nodes.size()));
    rt::define(out, "BROKEN_STACK",
               is("world_stack")   ? builder.depth_of_world + 1
               : is("small_stack") ? builder.depth - 1
                                   : (builder.depth + 8) / 8 * 8 + 24);
    rt::stat(out, "nodes", double(nodes.size()));
    return RT_OK;
}

int32_t levels(const rt_host*, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* out) {
    const auto* nodes = static_cast<const broken_node*>(built->slots[0]);
    std::vector<std::pair<rt_u32, rt_u32>> stack{{built->roots[group], 0}};
    while (!stack.empty()) {
        const auto [at, depth] = stack.back();
        stack.pop_back();
        const broken_node& node = nodes[at];
        if (node.count == BROKEN_EMPTY) continue;
        if (level == RT_LEVEL_BOTTOM ? node.count > 0 : depth == level)
            out->box(out->ctx, node.box, node.box + 3);
        else if (node.count == 0) {
            stack.push_back({node.first, depth + 1});
            stack.push_back({node.first + 1, depth + 1});
        }
    }
    return RT_OK;
}

// The surface area heuristic: the area of all boxes in units of the root's.
double area_of(const broken_node& node) {
    const double x = double(node.box[3]) - node.box[0], y = double(node.box[4]) - node.box[1],
                 z = double(node.box[5]) - node.box[2];
    return node.count == BROKEN_EMPTY ? 0 : x * y + y * z + z * x;
}
double cost_of(const broken_node* nodes, rt_u32 root, rt_u32 end) {
    double sum = 0;
    for (rt_u32 at = root; at < end; ++at) sum += area_of(nodes[at]);
    return area_of(nodes[root]) > 0 ? sum / area_of(nodes[root]) : 0;
}

// Nodes in the order of their making: children after their parents, group by group.
int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out) {
    auto* const nodes = static_cast<broken_node*>(out->slots[0]);
    const auto node_count = rt_u32(in->slot_counts[0]);
    has_refitted = is("build_after_refit");
    if (is("refit_throws")) throw std::runtime_error("the refit gave up");
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        if (!in->changed[g] && !is("refit_of_all")) continue;
        const rt_u32 end = g + 1 < in->group_count ? in->roots[g + 1] : node_count;
        const double cost_before = cost_of(nodes, in->roots[g], end);
        for (rt_u32 at = end; at-- > in->roots[g];) {
            broken_node& node = nodes[at];
            if (node.count == BROKEN_EMPTY) continue;
            if (is("refit_forgets_parent") && node.count == 0 && at % 5 == 2) continue;
            Box box;
            if (node.count > 0) {
                std::vector<rt_prim> prims(node.count);
                if (is("refit_skips") && node.first == 9) continue;
                rt::prims(in, node.first, node.count, prims.data());
                if (is("refit_asks_twice")) rt::prims(in, node.first, 1, prims.data());
                for (const rt_prim& prim : prims) box.add(prim);
            } else {
                for (rt_u32 child = node.first; child < node.first + 2; ++child)
                    for (int k = 0; k < 3; ++k) {
                        box.lo[k] = std::fmin(box.lo[k], nodes[child].box[k]);
                        box.hi[k] = std::fmax(box.hi[k], nodes[child].box[3 + k]);
                    }
            }
            if (is("refit_moves_leaves") && node.count == 2) ++node.first;  // the boxes are right
            if (is("refit_rounds_inwards") && node.count > 0)
                for (float& hi : box.hi) hi = std::nextafter(hi, -INFINITY);
            for (int k = 0; k < 3; ++k) {
                // Never smaller than it was: boxes of earlier poses stay in it.
                node.box[k] = is("refit_only_grows") ? std::fmin(node.box[k], box.lo[k]) : box.lo[k];
                node.box[3 + k] = is("refit_only_grows") ? std::fmax(node.box[3 + k], box.hi[k]) : box.hi[k];
            }
        }
        if (is("refit_costs_of_before"))
            out->cost(out->ctx, g, cost_before);
        else if (g == 0 || !is("refit_costs_of_world"))
            out->cost(out->ctx, g, is("refit_constant_cost") ? 1.0 : cost_of(nodes, in->roots[g], end));
        if (is("refit_ignores_group") && g + 1 < in->group_count) nodes[in->roots[g + 1]].box[0] -= 1;
    }
    if (is("refit_race") && in->group_count > 0 && in->changed[0]) {
        rt_u32 shared = 0;
        rt::parallel_for(host, 1000, [&](rt_u32 i) { shared = shared * 31 + i; });
        nodes[0].box[5] += float(shared % 1000) * 1e-3f;
    }
    return RT_OK;
}

// Positions stand in the order of the nodes: a node's own, then those of its children.
int32_t ranges(const rt_host*, const rt_built* built, rt_u32 group, rt_tree_ranges* out) {
    const auto* const nodes = static_cast<const broken_node*>(built->slots[0]);
    const rt_u32 root = built->roots[group];
    const rt_u32 end = group + 1 < built->group_count ? built->roots[group + 1] : rt_u32(built->slot_counts[0]);
    out->first_element = root;
    out->element_count = end - root;
    for (rt_u32 at = end; at-- > root;) {
        rt_u32* const range = out->ranges + 2 * size_t{at};
        const broken_node& node = nodes[at];
        if (node.count == BROKEN_EMPTY) continue;
        const rt_u32* const child = out->ranges + 2 * size_t{node.first};
        range[0] = node.count > 0 ? node.first : child[0];
        range[1] = node.count > 0 ? node.count : child[1] + child[3];
    }
    if (is("device_ranges_short") && out->ranges[2 * size_t{root} + 1] > 0) --out->ranges[2 * size_t{root} + 1];
    return RT_OK;
}

int32_t device_refit(const rt_host*, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double*) {
    using rt::number;
    using rt::of;
    const uint64_t each = rt::elements_each(plan), elements = tree->element_count[0];
    const int defect = is("device_refit_forgets")    ? 1
                       : is("device_refit_outside")  ? 2
                       : is("device_no_costs")       ? 3
                       : is("device_constant_costs") ? 4
                                                     : 0;
    rt::DeviceSteps steps(plan);
    steps.launch("broken_refit", (elements + each - 1) / each,
                 {of(tree->slots[0]), of(tree->ranges), of(blocks), number(tree->count), number(tree->first_element[0]),
                  number(elements), number(each), of(costs), number(uint64_t(defect))});
    return steps.result();
}

constexpr rt_cl_file kFiles[] = {
#include "broken.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<broken_node>("broken_nodes", "broken_node")};
rt_accel accel = rt::accel(kSlots, rt::file(kFiles, "broken_types.h"), rt::file(kFiles, "broken.cl"), rt::guarded<build>,
                           rt::guarded<levels>, rt::Traits());

// The host reads rt_plugin_v1 from the file, so it is a constant. What it points to may change while the library is loaded.
__attribute__((constructor)) void take_defect() {
    if (is("redefines_lanes"))
        accel.traverse.text =
            "#define RT_LANES 4\nvoid RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit) {}\n";
}

constexpr rt_refit kRefit = rt::refit(rt::guarded<refit>);
constexpr rt_device_build kDeviceBuild =
    rt::device_refit(rt::file(kFiles, "broken_build.cl"), rt::guarded<ranges>, rt::guarded<device_refit>);
constexpr rt_extension kExtensions[] = {rt::extension(kRefit), rt::extension(kDeviceBuild), rt::kNoMoreExtensions};

}  // namespace

const rt_plugin rt_plugin_v1 =
    rt::with_extensions(rt::accel_plugin("broken", "A defect", "1.0.0", nullptr, kParams, accel), kExtensions);
