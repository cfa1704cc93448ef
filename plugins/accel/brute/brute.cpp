// brute.cpp -- no structure: every ray tests every primitive, and where a work-group has a ray, its work-items share them.
//
// Ray tracers in hardware were built in this way, parallel over objects, with a reduction for each ray. On a GPU, long rays of
// queries are traced so, see brute.cl. Where rays are more than the device has work-items, one work-item a ray is as good, and
// nothing must be reduced (`linear`). Where they are fewer, the others would idle.
#include "clarity_space/tree.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "brute_types.h"

namespace brute {
namespace {

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    clarity::space::put_leaves(host, *in, out, clarity::space::primitive_count(host, *in));
    auto* const runs = rt::alloc<brute_run>(out, 0, in->group_count);
    rt_u32 at = 0;
    for (rt_u32 g = 0; g < in->group_count; at += in->groups[g++].count) {
        runs[g] = {at, in->groups[g].count};
        rt::root(out, g, g);
        rt::progress(host, 0.5f);
    }
    rt::stat(out, "nodes", in->group_count);
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "brute.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<brute_run>("brute_runs", "brute_run")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "brute_types.h"), rt::file(kFiles, "brute.cl"),
                                      rt::guarded<build>, nullptr, rt::Traits().tests_everything().can(RT_REQUEUES_LONG_RAYS));
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace
}  // namespace brute

const rt_plugin rt_plugin_v1 = rt::accel_plugin("brute", "List (work-groups share it)", "1.0.0", nullptr, brute::kAccel);
