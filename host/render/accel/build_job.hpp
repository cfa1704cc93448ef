// build_job.hpp -- what a build in a worker takes and returns.
#pragma once
#include <string>
#include <vector>

#include "base/files/parcel.hpp"
#include "render/accel/guarded_build.hpp"
#include "rt_plugin.h"
#include "scene/shared_array.hpp"

namespace clarity {

// The library of a builder, and its input. The arrays are the caller's, or lie in the parcel.
struct BuildJob {
    std::string library;
    uint64_t memory_bytes = 0;  // that the builder may map
    rt_device device{};
    std::vector<double> params;
    SharedArray<rt_prim> prims;
    SharedArray<rt_group> groups;
    SharedArray<rt_packed_prim> triangles;
    // The tree that is to be packed; no node: none.
    SharedArray<rt_topology_node> nodes;
    SharedArray<rt_u32> refs, roots;

    BuildJob() = default;
    BuildJob(std::string library_file, uint64_t memory, const rt_build_input& input, uint64_t prim_count, rt_u32 param_count,
             const rt_topology* tree);
    template <class Parcel, class Self>
    static void visit(Parcel& parcel, Self& self) {
        parcel(self.library, self.memory_bytes, self.device, self.params, self.prims, self.groups, self.triangles, self.nodes,
               self.refs, self.roots);
    }
};

// What a builder wrote, in the worker; in the program it calls the functions of `out` as the builder did. The worker is not
// trusted: every size is checked.
struct BuildReplay {
    const rt_accel& accel;
    rt_u32 group_count;
    const rt_build_output& out;
    static void visit(ParcelReader& parcel, BuildReplay& replay);
};
struct BuildAnswer {
    const BuilderResult& result;
    static void visit(ParcelWriter& parcel, const BuildAnswer& answer);
};

// The work of kBuildJob.
void build_job(ParcelReader& arguments);

}  // namespace clarity
