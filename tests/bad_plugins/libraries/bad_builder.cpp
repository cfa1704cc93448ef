// A linear list. Its builder breaks the contract in the way that its parameter names; with "none" it builds correctly.
#include <cstring>
#include <stdexcept>

#include "rt_plugin.hpp"

namespace {

const char* const kDefects[] = {"none",
                                "fails",
                                "fails_silently",
                                "ok_after_fail",
                                "odd_status",
                                "cancelled_by_nobody",
                                "crashes",
                                "throws",
                                "throws_no_exception_class",
                                "throws_in_loop",
                                "fails_in_loop",
                                "alloc_twice",
                                "alloc_of_no_slot",
                                "alloc_too_much",
                                "no_slot",
                                "no_leaves",
                                "leaves_twice",
                                "leaves_too_many",
                                "ref_of_no_primitive",
                                "ref_of_no_kind",
                                "missing_root",
                                "root_out_of_range",
                                "root_of_no_group",
                                "define_of_odd_name",
                                "define_of_no_name",
                                "stat_of_no_name",
                                "deep_stack",
                                nullptr};

struct Run {
    rt_u32 first, count;
};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    const char* defect = kDefects[static_cast<size_t>(in->params[0])];
    const auto is = [&](const char* name) { return std::strcmp(defect, name) == 0; };
    if (is("fails")) return host->fail(host->ctx, "this builder always fails");
    if (is("fails_silently")) return RT_FAILED;
    if (is("ok_after_fail")) host->fail(host->ctx, "this builder failed and goes on");
    if (is("odd_status")) return 77;
    if (is("cancelled_by_nobody")) return RT_CANCELLED;
    if (is("crashes")) {
        volatile int* volatile nowhere = nullptr;
        *nowhere = 1;
    }
    if (is("throws")) throw std::runtime_error("thrown by the builder");
    if (is("throws_no_exception_class")) throw 42;
    if (is("throws_in_loop"))
        host->parallel_for(
            host->ctx, 1000,
            [](void*, rt_u32 i) {
                if (i >= 7) throw std::runtime_error("thrown in iteration " + std::to_string(i));
            },
            nullptr);
    if (is("fails_in_loop"))
        host->parallel_for(
            host->ctx, 1000,
            [](void* user, rt_u32) {
                static_cast<const rt_host*>(user)->fail(static_cast<const rt_host*>(user)->ctx, "one of many");
            },
            const_cast<rt_host*>(host));

    rt_u32 total = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) total += in->groups[g].count;
    if (is("alloc_of_no_slot")) out->alloc(out->ctx, 1, 4);
    if (is("alloc_too_much")) out->alloc(out->ctx, 0, UINT64_MAX / 4);
    auto* runs = is("no_slot") ? nullptr : static_cast<Run*>(out->alloc(out->ctx, 0, in->group_count));
    if (!runs && !is("no_slot")) return RT_FAILED;
    if (is("alloc_twice")) out->alloc(out->ctx, 0, in->group_count);
    if (is("leaves_too_many")) out->leaves(out->ctx, UINT64_MAX / 8);
    rt_u32* leaves = is("no_leaves") ? nullptr : out->leaves(out->ctx, total);
    if (!leaves && !is("no_leaves")) return RT_FAILED;
    if (is("leaves_twice")) out->leaves(out->ctx, total);
    rt_u32 next = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        const rt_group group = in->groups[g];
        if (runs) runs[g] = {next, group.count};
        for (rt_u32 i = 0; i < group.count && leaves; ++i) leaves[next++] = in->prims[group.first + i].ref;
        if (is("missing_root") && g + 1 == in->group_count) continue;
        out->root(out->ctx, g, is("root_out_of_range") ? in->group_count + 1000 : g);
    }
    if (is("root_of_no_group")) out->root(out->ctx, in->group_count, 0);
    if (leaves && total > 0) {
        if (is("ref_of_no_primitive")) leaves[0] = RT_REF_INDEX_MAX;
        if (is("ref_of_no_kind")) leaves[0] = 0x90000000u;
    }
    if (is("define_of_odd_name")) out->define(out->ctx, "1 ); abort(", 1);
    if (is("define_of_no_name")) out->define(out->ctx, nullptr, 1);
    if (is("stat_of_no_name")) out->stat(out->ctx, nullptr, 1);
    // 16 MiB, of which a thread has 8: but not for the small scene on which kernels are tried.
    if (is("deep_stack")) out->define(out->ctx, "BAD_BUILDER_STACK", total > 5000 ? 4u << 20 : 8192);
    return RT_OK;
}

constexpr rt_slot kSlots[] = {rt::slot<Run>("bad_builder_runs", "uint2")};
constexpr rt_param kParams[] = {rt::enum_param("defect", "Defect", "what the builder does wrong", kDefects, 0)};
// Not wrapped in rt::guarded: the host must stop the exceptions of a careless plugin.
// Pushes all primitives before it tests the first.
constexpr const char* kKernel = R"(
#ifndef BAD_BUILDER_STACK
#define BAD_BUILDER_STACK 8192
#endif
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    uint stack[BAD_BUILDER_STACK], top = 0;
    const uint2 run = ctx->bad_builder_runs[root];
    for (uint i = 0; i < run.y; ++i) stack[top++] = run.x + i;
    while (top) RT_LEAF(ctx, stack[--top], ray, hit);
}
)";
constexpr rt_accel kAccel = rt::accel(kSlots, {}, {"bad_builder.cl", kKernel}, build, nullptr, {});

}  // namespace

const rt_plugin rt_plugin_v1 =
    rt::accel_plugin("bad_builder", "A builder that breaks its contract", "1.0", nullptr, kParams, kAccel);
