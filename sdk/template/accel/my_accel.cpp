// my_accel.cpp -- builds a list of boxes. Each box encloses a few primitives, in the order of the file. Replace it by your own
// structure.
#include "rt_plugin.hpp"
// included after rt_plugin.hpp, because it uses its types:
#include "my_accel_types.h"

#include <algorithm>
#include <cmath>

namespace {

enum Param { kBlockSize };
constexpr rt_param kParams[] = {rt::int_param("block", "Block size", "primitives in a box, at most", 1, 64, 8)};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    const rt_u32 size = static_cast<rt_u32>(in->params[kBlockSize]);
    rt_u32 prim_count = 0, block_count = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        prim_count += in->groups[g].count;
        block_count += (in->groups[g].count + size - 1) / size;
    }
    auto* runs = rt::alloc<my_accel_run>(out, 0, in->group_count);
    auto* blocks = rt::alloc<my_accel_block>(out, 1, block_count);
    rt_u32 *leaves = rt::leaves(out, prim_count), leaf = 0, block = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        const rt_prim* prims = in->prims + in->groups[g].first;
        runs[g] = {block, (in->groups[g].count + size - 1) / size};
        for (rt_u32 i = 0; i < in->groups[g].count; ++i, ++leaf) {
            if (i % size == 0) blocks[block++] = {{INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY}, leaf, 0};
            my_accel_block& b = blocks[block - 1];
            for (int axis = 0; axis < 3; ++axis) {
                b.box[axis] = std::min(b.box[axis], prims[i].lo[axis]);
                b.box[axis + 3] = std::max(b.box[axis + 3], prims[i].hi[axis]);
            }
            ++b.count;
            leaves[leaf] = prims[i].ref;
        }
        rt::root(out, g, g);  // call it for every group, also for an empty one
        rt::progress(host, float(g + 1) / float(in->group_count));
    }
    rt::stat(out, "nodes", block_count);
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "my_accel.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<my_accel_run>("my_accel_runs", "my_accel_run"),
                              rt::slot<my_accel_block>("my_accel_blocks", "my_accel_block")};
// When the structure is fast enough to be a default, add rt::Traits().merit(cpu, gpu) with the result of `clarity bench accel`;
// rt_plugin.h has the unit. Until then the host takes this structure only if the user names it.
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "my_accel_types.h"), rt::file(kFiles, "my_accel.cl"),
                                      rt::guarded<build>, nullptr, rt::Traits().tests_everything());

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("my_accel", "My structure", "0.1.0", nullptr, kParams, kAccel);
