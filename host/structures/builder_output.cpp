#include "structures/builder_output.hpp"

namespace clarity {
namespace {

constexpr rt_slot kNodes[] = {{"nodes", nullptr, sizeof(rt_topology_node), RT_SLOT_HOST_ONLY}};

constexpr rt_accel topology_slots() {
    rt_accel accel{};
    accel.struct_bytes = sizeof accel;
    accel.slot_count = 1;
    accel.slot_bytes = sizeof(rt_slot);
    accel.slots = kNodes;
    return accel;
}
constexpr rt_accel kTopology = topology_slots();

const rt_build_output& output(void* ctx) {
    return *static_cast<const rt_build_output*>(ctx);
}

}  // namespace

const rt_accel& built_slots(const rt_plugin& plugin) {
    return plugin.accel->topology ? kTopology : *plugin.accel;
}

int32_t run_builder(const rt_plugin& plugin, const rt_host* host, const rt_build_input* input, const rt_topology* tree,
                    const rt_build_output* out) {
    if (tree) return plugin.accel->pack(host, input, tree, out);
    if (!plugin.accel->topology) return plugin.accel->build(host, input, out);
    rt_topology_output table{};
    table.struct_bytes = sizeof table;
    table.ctx = const_cast<rt_build_output*>(out);
    table.nodes = [](void* ctx, uint64_t count) {
        return static_cast<rt_topology_node*>(output(ctx).alloc(output(ctx).ctx, 0, count));
    };
    table.refs = [](void* ctx, uint64_t count) { return output(ctx).leaves(output(ctx).ctx, count); };
    table.root = [](void* ctx, rt_u32 group, rt_u32 node) { output(ctx).root(output(ctx).ctx, group, node); };
    table.stat = [](void* ctx, const char* label, double value) { output(ctx).stat(output(ctx).ctx, label, value); };
    return plugin.accel->topology(host, input, &table);
}

}  // namespace clarity
