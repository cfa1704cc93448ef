// broken_device.cpp -- a builder with one defect (own_defect.hpp). The device builds the same trees.
// `clarity check` must find each, and none in the plugin with the defect `none`.
#include <algorithm>
#include <vector>

#include "own_defect.hpp"
#include "rt_device.hpp"

namespace {

bool is(const char* defect) {
    return own_defect("device_") == defect;
}
// The kernel's name of a defect.
constexpr const char* kInKernel[] = {"none", "box", "loses", "counts", "state", "group_size", "writes_input"};
uint64_t number_of_defect() {
    uint64_t number = 0;
    for (uint64_t i = 0; i < sizeof kInKernel / sizeof kInKernel[0]; ++i)
        if (is(kInKernel[i])) number = i;
    return number;
}

// On the host: halves along the longest axis.
struct Halves {
    rt_topology_node* nodes;
    rt_u32 *refs, node = 0, ref = 0;
    rt_u32 split(rt_prim* begin, rt_prim* end) {
        const rt_u32 at = node++, count = rt_u32(end - begin);
        rt_topology_node n{{3e38f, 3e38f, 3e38f}, ref, {-3e38f, -3e38f, -3e38f}, RT_TOPOLOGY_LEAF | 1u};
        for (const rt_prim* p = begin; p < end; ++p)
            for (int k = 0; k < 3; ++k) n.lo[k] = std::min(n.lo[k], p->lo[k]), n.hi[k] = std::max(n.hi[k], p->hi[k]);
        if (count == 1) {
            refs[ref++] = begin->ref;
        } else {
            int axis = 0;
            for (int k = 1; k < 3; ++k) axis = n.hi[k] - n.lo[k] > n.hi[axis] - n.lo[axis] ? k : axis;
            std::nth_element(begin, begin + count / 2, end,
                             [=](const rt_prim& a, const rt_prim& b) { return a.lo[axis] < b.lo[axis]; });
            n.left = split(begin, begin + count / 2), n.right = split(begin + count / 2, end);
        }
        return nodes[at] = n, at;
    }
};

int32_t build(const rt_host*, const rt_build_input* in, const rt_topology_output* out) {
    uint64_t count = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) count += in->groups[g].count;
    Halves tree{rt::nodes(out, 2 * count), rt::refs(out, count)};
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        std::vector<rt_prim> p(in->prims + in->groups[g].first, in->prims + in->groups[g].first + in->groups[g].count);
        rt::root(out, g, p.empty() ? RT_NONE : tree.split(p.data(), p.data() + p.size()));
    }
    return RT_OK;
}

int32_t plan(const rt_host* host, const rt_device_plan* plan, const rt_device_input* in, rt_device_topology* tree) {
    using rt::number;
    using rt::of;
    if (is("gives_up")) return host->fail(host->ctx, "there is no plan for this");
    const uint64_t n = in->count, each = rt::elements_each(plan);
    rt::DeviceSteps steps(plan);
    tree->order = steps.buffer(4 * n);
    tree->nodes = steps.buffer(sizeof(rt_topology_node) * n);
    tree->counts = steps.buffer(4 * n);
    tree->root = steps.buffer(4);
    const rt_u32 keys = steps.buffer(is("small_buffer") ? 4 * n : 8 * n), runs = steps.buffer(4);
    if (is("unknown_buffer")) steps.scan(1000, n);
    steps.curve(in->prims, n, 16, keys, tree->order);
    if (n > 1) {
        const rt_u32 blocks = steps.blocks(in->prims, tree->order, n);
        if (is("state")) steps.launch("count_runs", 1, {of(runs)});
        std::vector<rt_device_arg> args = {of(blocks),
                                           number(n),
                                           number(each),
                                           of(tree->nodes),
                                           of(tree->counts),
                                           of(tree->root),
                                           number(number_of_defect()),
                                           of(runs),
                                           of(in->prims)};
        if (is("arguments")) args.pop_back();
        steps.launch(is("no_kernel") ? "halves_node" : "halves_nodes", (n - 1 + each - 1) / each, args);
    }
    for (uint64_t half = 1; half < n; half *= 2) ++tree->depth;
    if (is("depth") && n > 4) --tree->depth;
    return steps.result();
}

constexpr rt_cl_file kFiles[] = {
#include "broken_device.inc"
};
constexpr rt_accel kAccel = rt::topology("bvh4", rt::guarded<build>, rt::Traits());
constexpr rt_device_build kBuild = rt::device_topology(rt::file(kFiles, "broken_device.cl"), rt::guarded<plan>);
constexpr rt_extension kExtensions[] = {rt::extension(kBuild), rt::kNoMoreExtensions};

}  // namespace

const rt_plugin rt_plugin_v1 =
    rt::with_extensions(rt::accel_plugin("broken_device", "A defect", "1.0.0", nullptr, kAccel), kExtensions);
