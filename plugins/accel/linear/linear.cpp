// linear.cpp -- no structure at all: every ray tests every primitive, in order. It is slow and hard to get wrong. So it is the
// reference for the other structures, and the shortest example of a plugin.
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "linear_types.h"

namespace {

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    uint64_t count = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) count += input->groups[g].count;
    if (count > RT_REF_INDEX_MAX) throw rt::fail(host, "holds 2^28 - 1 primitives at most: use a tree, and instance meshes");

    auto* runs = rt::alloc<linear_run>(out, 0, input->group_count);
    rt_u32* leaves = rt::leaves(out, count);
    rt_u32 at = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) {
        const rt_group& group = input->groups[g];
        runs[g] = {at, group.count};
        for (rt_u32 i = 0; i < group.count; ++i) leaves[at++] = input->prims[group.first + i].ref;
        rt::root(out, g, g);
        rt::progress(host, static_cast<float>(at) / static_cast<float>(count + 1));
    }
    rt::stat(out, "nodes", input->group_count);
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "linear.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<linear_run>("linear_runs", "linear_run")};
// There are no bounding volumes, so `levels` is null.
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "linear_types.h"), rt::file(kFiles, "linear.cl"),
                                      rt::guarded<build>, nullptr, rt::Traits().tests_everything());
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("linear", "List (tests everything)", "1.0.0", nullptr, kAccel);
