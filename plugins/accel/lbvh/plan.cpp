#include "plan.hpp"

#include "clarity_bvh/build/morton_order.hpp"
#include "rt_device.hpp"

namespace lbvh {
namespace {

using namespace clarity::bvh;
using rt::number;
using rt::of;

constexpr uint64_t kNodeBytes = 32;

}  // namespace

int32_t plan(const rt_host*, const rt_device_plan* plan, const rt_device_input* input, rt_device_topology* result) {
    const uint64_t n = input->count, each = rt::elements_each(plan);
    rt::DeviceSteps steps(plan);
    const rt_u32 order = steps.buffer(4 * n), nodes = steps.buffer(kNodeBytes * n), counts = steps.buffer(4 * n);
    if (n > 0) {
        const rt_u32 keys = steps.buffer(8 * n);
        steps.curve(input->prims, n, axis_bits(n), keys, order);
        if (n > 1) {
            const rt_u32 blocks = steps.blocks(input->prims, order, n);
            steps.launch("lbvh_nodes", (n - 1 + each - 1) / each,
                         {of(keys), of(blocks), number(n), number(each), of(nodes), of(counts)});
        }
    }
    result->nodes = nodes;
    result->counts = counts;
    result->order = order;
    result->depth = depth_bound(n);
    return steps.result();
}

}  // namespace lbvh
