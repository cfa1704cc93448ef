#include "structures/guarded_build.hpp"

#include <cstring>

namespace clarity {
namespace {

template <class T>
GuardedBytes read_only_copy(const T* data, uint64_t count, const char* name) {
    GuardedBytes copy(count * sizeof(T), name, sizeof(T) % 16 == 0 ? 16 : alignof(T), sizeof(T));
    if (count > 0) std::memcpy(copy.data(), data, count * sizeof(T));
    copy.make_read_only();
    return copy;
}

}  // namespace

BuilderInput::BuilderInput(const rt_prim* prim_array, uint64_t prims_in_all, const rt_group* group_array, rt_u32 groups_in_all,
                           const rt_packed_prim* triangle_array, uint64_t triangles_in_all, std::vector<double> values,
                           const rt_device& for_device)
    : prims(read_only_copy(prim_array, prims_in_all, "the builder's input prims (read-only)")),
      groups(read_only_copy(group_array, groups_in_all, "the builder's input groups (read-only)")),
      triangles(read_only_copy(triangle_array, triangles_in_all, "the builder's input triangles (read-only)")),
      params(std::move(values)),
      device(for_device),
      group_count(groups_in_all),
      prim_count(prims_in_all),
      triangle_count(triangles_in_all) {}

void BuilderInput::set_tree(const rt_topology& tree) {
    nodes = read_only_copy(tree.nodes, tree.node_count, "the tree's nodes (read-only)");
    refs = read_only_copy(tree.refs, tree.ref_count, "the tree's refs (read-only)");
    roots = read_only_copy(tree.roots, tree.group_count, "the tree's roots (read-only)");
    tree_ = {sizeof tree_,
             tree.group_count,
             static_cast<const rt_topology_node*>(nodes.data()),
             tree.node_count,
             static_cast<const rt_u32*>(refs.data()),
             tree.ref_count,
             static_cast<const rt_u32*>(roots.data())};
}

const rt_build_input& BuilderInput::table() {
    geometry_ = {sizeof(rt_geometry), static_cast<const rt_packed_prim*>(triangles.data()), triangle_count};
    table_.struct_bytes = sizeof table_;
    table_.group_count = group_count;
    table_.prims = static_cast<const rt_prim*>(prims.data());
    table_.groups = static_cast<const rt_group*>(groups.data());
    table_.geometry = &geometry_;
    table_.params = params.data();
    table_.device = &device;
    return table_;
}

GuardedOutput::GuardedOutput(const rt_plugin& plugin, rt_u32 group_count, HostServices& services)
    : BuilderOutput(built_slots(plugin), group_count, services,
                    [](uint64_t count, size_t element_bytes, const std::string& name) {
                        return GuardedBytes(count * element_bytes, name, 128, element_bytes);
                    }) {}

std::string overrun_of(const BuilderResult& result) {
    for (const BuilderResult::Slot& slot : result.slots)
        if (!slot.memory.intact()) return slot.memory.name();
    return result.refs.intact() ? "" : result.refs.name();
}

}  // namespace clarity
