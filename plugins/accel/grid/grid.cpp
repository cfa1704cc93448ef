// grid.cpp -- a uniform grid for each group: Fujimoto, Tanaka, Iwata 1986, "ARTS: Accelerated Ray-Tracing System"; Cleary,
// Wyvill 1988, "Analysis of an algorithm for fast ray tracing using uniform space subdivision", for the number of cells.
//
// Packets go from slice to slice instead of from cell to cell, as long as their rays stay together: Wald, Ize, Kensler, Knoll,
// Parker 2006, "Ray Tracing Animated Scenes using Coherent Grid Traversal".
//
// A cell takes 4 bytes, a block of 64 cells 8 more, and a primitive 8 for each cell that it is in: its name, and where in the
// cell its box is (cl/lanes/cell_parts.h). On a CPU most names are passed over by that box, 16 at a time, so cells may be
// large there. The traversal needs no stack. A build takes time in proportion to the primitives and cells, and rays meet cells
// in the order of their distances. It is good at primitives of one size that fill their box, such as height fields. It is bad
// at a small object in a large scene, which lies in few cells, and at empty space, through which a single ray goes cell by
// cell, and a packet four slices of cells at once.
#include <algorithm>
#include <cfloat>
#include <memory>
#include <vector>

#include "clarity_space/cells.hpp"
#include "clarity_space/tree.hpp"
#include "rt_cost.hpp"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "grid_types.h"

namespace {

using namespace clarity::space;

enum Param { kDensity, kExact };
constexpr rt_param kParams[] = {
    rt::float_param("density", "Density", "cells for each primitive; 0: 1 on a CPU, 3 on a GPU", 0, 64, 0),
    rt::bool_param("exact", "Exact", "a triangle is in the cells that its plane meets; else in all that its box meets", true),
};

// Cells for each primitive of a group. On a GPU, which reads no boxes in cells, smaller cells save tests.
double density_of(const rt_build_input& in, rt_u32 group) {
    const bool is_gpu = in.device->kind == RT_DEVICE_GPU;
    const double world = in.params[kDensity] > 0 ? in.params[kDensity] : is_gpu ? 3 : 1;
    // A mesh of instances. These are often small in the picture: then a packet covers so much of one that boxes in cells save
    // no tests, and only the order of small cells does.
    constexpr double kInstanced = 4;
    return group > 0 && !is_gpu ? kInstanced * world : world;
}

constexpr grid_head kOneCell{{0, 0, 0, 0, 0, 0}, {1, 1, 1}, {1, 1, 1}, 0, 0, {0, 0}};

// Blocks of 4 x 4 x 4 cells, along one axis.
size_t blocks_along(const grid_head& grid, int axis) {
    return (size_t{grid.cells[axis]} + 3) / 4;
}
size_t block_count(const grid_head& grid) {
    return blocks_along(grid, 0) * blocks_along(grid, 1) * blocks_along(grid, 2);
}

// Notes which cells of each block have a primitive: cell (x, y, z) of a block is bit x + 4 y + 16 z.
void fill_blocks(const rt_host* host, const grid_head& grid, const rt_u32* starts, uint64_t* blocks) {
    const size_t row = blocks_along(grid, 0), layer = row * blocks_along(grid, 1);
    rt::parallel_for(host, rt_u32(blocks_along(grid, 2)), [&](rt_u32 block_z) {
        for (size_t z = 4 * size_t{block_z}; z < std::min<size_t>(4 * size_t{block_z} + 4, grid.cells[2]); ++z)
            for (size_t y = 0; y < grid.cells[1]; ++y) {
                const rt_u32* const cells = starts + (z * grid.cells[1] + y) * grid.cells[0];
                uint64_t* const of_row = blocks + block_z * layer + y / 4 * row;
                for (size_t x = 0; x < grid.cells[0]; ++x)
                    of_row[x / 4] |= uint64_t{cells[x + 1] > cells[x]} << (x % 4 + 4 * (y % 4) + 16 * (z % 4));
            }
    });
}

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    const rt_u32 count = primitive_count(host, *in);
    auto* const heads = rt::alloc<grid_head>(out, 0, in->group_count);
    std::vector<std::unique_ptr<CellSort<grid_head, true>>> sorts(in->group_count);
    rt::parallel_for(host, in->group_count, [&](rt_u32 g) {
        const rt_group& group = in->groups[g];
        const Prims prims{in->prims + group.first, in->params[kExact] != 0 ? in->geometry->triangles : nullptr};
        const Extent extent = extent_of(host, prims.prims, group.count);
        heads[g] = kOneCell;
        if (extent.count > 0) shape_cells(heads[g], extent.lo, extent.hi, density_of(*in, g) * extent.count);
        sorts[g] = std::make_unique<CellSort<grid_head, true>>(host, heads[g], prims, group.count, [](rt_u32 i) { return i; });
    });

    uint64_t starts = 0, references = 0, filled = 0, blocks = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        starts += sorts[g]->lists() + 1, references += sorts[g]->references();
        heads[g].first_block = rt_u32(blocks), blocks += block_count(heads[g]);
    }
    if (starts > 0xFFFFFFF0u || references > 0xFFFFFFF0u) throw rt::fail(host, "needs more than 2^32 cells: lower `density`");
    auto* const start = rt::alloc<rt_u32>(out, 1, starts);
    auto* const list = rt::alloc<rt_u32>(out, 2, references);
    auto* const block = rt::alloc<uint64_t>(out, 3, blocks);
    auto* const parts = rt::alloc<rt_u32>(out, 4, references + 16);  // kernels read as many at once
    put_leaves(host, *in, out, count);
    rt_u32 cell = 0, place = 0, first = 0;  // the group's first cell, and its first places in the list and in leaf order
    rt::ExpectedCost expected;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        heads[g].first = cell;
        filled += sorts[g]->write(host, start + cell, list + place, place, first, parts + place);
        fill_blocks(host, heads[g], start + cell, block + heads[g].first_block);
        const double whole = rt::surface_of(heads[g].box);
        rt::Surfaces sums;
        add_cells(heads[g], start + cell, whole, sums);
        expected.add_group(in->groups[g].count, whole, sums);
        cell += rt_u32(sorts[g]->lists() + 1), place += rt_u32(sorts[g]->references()), first += in->groups[g].count;
        sorts[g].reset();
        rt::root(out, g, g);
    }
    rt::stat(out, "nodes", double(starts - 2 * in->group_count));
    rt::stat(out, "leaves", double(filled));
    rt::stat(out, "references", double(references));
    expected.report(out);
    return RT_OK;
}

// Level 0 is the box, level 1 the cells with primitives. Primitives that are too large for cells may be anywhere: each level
// then has all of space, too.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const grid_head& grid = static_cast<const grid_head*>(built->slots[0])[built->roots[group]];
    const rt_u32* const starts = static_cast<const rt_u32*>(built->slots[1]) + grid.first;
    const rt_u32 cells = rt_u32(cell_count(grid));
    if (level != RT_LEVEL_BOTTOM && level > 1) return RT_OK;
    if (starts[cells + 1] > starts[cells]) {
        const float lo[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX}, hi[3] = {FLT_MAX, FLT_MAX, FLT_MAX};
        sink->box(sink->ctx, lo, hi);
    }
    if (level == 0 && starts[cells] > starts[0]) sink->box(sink->ctx, grid.box, grid.box + 3);
    for (rt_u32 cell = 0; level != 0 && cell < cells; ++cell) {
        if (starts[cell + 1] == starts[cell]) continue;
        float lo[3], hi[3];
        cell_box(grid, cell, lo, hi);
        sink->box(sink->ctx, lo, hi);
    }
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "grid.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<grid_head>("grid_heads", "grid_head"), rt::slot<rt_u32>("grid_starts", "uint"),
                              rt::slot<rt_u32>("grid_list", "uint"), rt::slot<uint64_t>("grid_blocks", "ulong"),
                              rt::slot<rt_u32>("grid_parts", "uint")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "grid_types.h"), rt::file(kFiles, "grid.cl"), rt::guarded<build>,
                                      rt::guarded<levels>, rt::Traits().can(RT_TRAVERSES_SINGLE_RAYS));
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin(
    "grid", "Uniform grid", "1.0.0", "Fujimoto, Tanaka, Iwata 1986, ARTS: Accelerated Ray-Tracing System", kParams, kAccel);
