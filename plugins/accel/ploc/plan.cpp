#include "plan.hpp"

#include "clarity_bvh/build/morton_order.hpp"
#include "limits.hpp"
#include "rt_device.hpp"

namespace ploc {
namespace {

using namespace clarity::bvh;
using rt::number;
using rt::of;

constexpr uint64_t kNodeBytes = 32, kPlaceBytes = 16;
constexpr uint64_t kGroupsPerUnit = 8;  // that join ranges of several groups

}  // namespace

int32_t plan(const rt_host*, const rt_device_plan* plan, const rt_device_input* input, rt_device_topology* result) {
    const uint64_t n = input->count, groups = (n + plan->group_items - 1) / plan->group_items;
    rt::DeviceSteps steps(plan);
    const rt_u32 order = steps.buffer(4 * n), nodes = steps.buffer(kNodeBytes * n), counts = steps.buffer(4 * n);
    const rt_u32 root = steps.buffer(8);
    if (n > 0) {
        const rt_u32 keys = steps.buffer(8 * n);
        steps.curve(input->prims, n, axis_bits(n), keys, order);
        const rt_u32 places = steps.buffer(kPlaceBytes * n);
        const auto launch = [&](const char* kernel, uint64_t work_groups, const std::vector<rt_device_arg>& more) {
            std::vector<rt_device_arg> args = {of(input->prims), of(order),  of(keys), of(nodes),
                                               of(counts),       of(places), number(n)};
            args.insert(args.end(), more.begin(), more.end());
            steps.launch(kernel, work_groups, args);
        };
        const uint32_t limit = height_limit(n);
        if (plan->has_warps) {
            const rt_u32 waiting = steps.buffer(8 * (n + 1)), siblings = steps.buffer(4 * n),
                         of_radix_tree = steps.buffer(4 * n);
            if (n > 1) {
                launch("ploc_windows", groups, {of(waiting), of(root)});
                launch("ploc_climb", plan->units * kGroupsPerUnit, {of(waiting), of(siblings), of(root)});
                launch("ploc_limit", groups, {of(waiting), of(of_radix_tree), of(root), number(limit)});
            }
        } else {
            const uint64_t parts = parts_of(n);
            const rt_u32 pending = steps.buffer(4 * kPendingWords * parts);
            launch("ploc_parts", (parts + plan->group_items - 1) / plan->group_items, {number(kPart), of(pending), of(root)});
            launch("ploc_join_parts", 1, {number(kPart), of(pending), of(root), number(limit)});
        }
    }
    result->nodes = nodes;
    result->counts = counts;
    result->order = order;
    result->root = root;
    result->depth = height_limit(n);
    return steps.result();
}

}  // namespace ploc
