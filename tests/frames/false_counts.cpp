// false_counts.cpp -- a plugin: a list of primitives whose traversal reports false counts, by the macros and by writing to the
// hit.
#include "rt_plugin.hpp"

namespace {

constexpr rt_cl_file kTypes = {"false_counts_types.h",
                               "typedef struct false_counts_run {\n    uint first, count;\n} false_counts_run;\n"};
constexpr rt_cl_file kTraversal = {"false_counts.cl", R"(
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const global false_counts_run *run = RT_NODE(ray, ctx->false_counts_runs + root);
    vfloat entry;
    rt_enter_box((const global float *)ctx->leaves, ray, hit, &entry);
    RT_COUNT_VISIT(hit, 1u);
    RT_COUNT_LEAVES(hit, 1000u);
    for (uint i = 0; i < run->count; ++i) RT_LEAF(ctx, run->first + i, ray, hit);
#ifdef RT_COUNT_STEPS
    hit->steps = hit->leaf_tests = hit->boxes = 7777u;
#endif
}
)"};

struct Run {
    rt_u32 first, count;
};

int32_t build(const rt_host*, const rt_build_input* input, const rt_build_output* out) {
    rt_u32 count = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) count += input->groups[g].count;
    auto* runs = rt::alloc<Run>(out, 0, input->group_count);
    rt_u32 *leaves = rt::leaves(out, count), at = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g) {
        const rt_group& group = input->groups[g];
        runs[g] = {at, group.count};
        for (rt_u32 i = 0; i < group.count; ++i) leaves[at++] = input->prims[group.first + i].ref;
        rt::root(out, g, g);
    }
    return RT_OK;
}

constexpr rt_slot kSlots[] = {rt::slot<Run>("false_counts_runs", "false_counts_run")};
constexpr rt_accel kAccel = rt::accel(kSlots, kTypes, kTraversal, rt::guarded<build>, nullptr, rt::Traits().tests_everything());

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("false_counts", "False counts", "1", nullptr, kAccel);
