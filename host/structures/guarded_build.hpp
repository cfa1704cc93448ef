// guarded_build.hpp -- runs a builder on memory between guard pages. For worker processes, in which a plugin may crash.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "rt_plugin.h"
#include "structures/builder_output.hpp"
#include "worker/guarded_memory.hpp"

namespace clarity {

// The input of a builder as this process owns it.
struct BuilderInput {
    GuardedBytes prims, groups, triangles, nodes, refs, roots;
    std::vector<double> params;
    rt_device device;
    rt_u32 group_count = 0;
    uint64_t prim_count = 0, triangle_count = 0;

    // Copies the arrays into read-only memory.
    BuilderInput(const rt_prim* prim_array, uint64_t prims_in_all, const rt_group* group_array, rt_u32 groups_in_all,
                 const rt_packed_prim* triangle_array, uint64_t triangles_in_all, std::vector<double> values,
                 const rt_device& for_device);
    // Copies the tree which is to be packed into read-only memory.
    void set_tree(const rt_topology& tree);
    // The tables that a builder gets. Valid as long as this object.
    const rt_build_input& table();
    const rt_topology* tree() const { return tree_.nodes ? &tree_ : nullptr; }

 private:
    rt_geometry geometry_{};
    rt_build_input table_{};
    rt_topology tree_{};
};

using BuilderResult = BuilderResultIn<GuardedBytes>;

// Receives what a builder writes.
class GuardedOutput : public BuilderOutput<GuardedBytes> {
 public:
    GuardedOutput(const rt_plugin& plugin, rt_u32 group_count, HostServices& services);
};

// Which memory was written beyond its end; empty: none.
std::string overrun_of(const BuilderResult& result);

}  // namespace clarity
