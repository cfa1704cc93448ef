// A linear list that takes the trees of other builders. It crashes if there is more than one group.
#include "rt_plugin.hpp"

namespace {

struct Run {
    rt_u32 first, count;
};

int32_t build(const rt_host* host, const rt_build_input*, const rt_build_output*) {
    return host->fail(host->ctx, "it only packs");
}

int32_t pack(const rt_host*, const rt_build_input* in, const rt_topology* tree, const rt_build_output* out) {
    volatile int* volatile nowhere = nullptr;
    if (in->group_count > 1) *nowhere = 1;
    Run* runs = rt::alloc<Run>(out, 0, 1);
    runs[0] = {tree->nodes[tree->roots[0]].left, tree->nodes[tree->roots[0]].right & ~RT_TOPOLOGY_LEAF};
    rt_u32* leaves = rt::leaves(out, tree->ref_count);
    for (uint64_t i = 0; i < tree->ref_count; ++i) leaves[i] = tree->refs[i];
    rt::root(out, 0, 0);
    return RT_OK;
}

constexpr rt_slot kSlots[] = {rt::slot<Run>("bad_packer_runs", "uint2")};
constexpr rt_accel kAccel = rt::accel(kSlots, {}, {"bad_packer.cl", "void RT_TRAVERSE() {}"}, build, nullptr, {}, pack);

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("bad_packer", "A structure that crashes when it packs", "1.0", nullptr, kAccel);
