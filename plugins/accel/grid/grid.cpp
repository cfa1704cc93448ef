// grid.cpp -- a uniform grid for each group: Fujimoto, Tanaka, Iwata 1986, "ARTS: Accelerated Ray-Tracing System"; Cleary,
// Wyvill 1988, "Analysis of an algorithm for fast ray tracing using uniform space subdivision", for the number of cells.
//
// A cell takes 4 bytes, and 4 for each primitive in it. The traversal needs no stack. A build takes time in proportion to the
// primitives and cells, and rays meet cells in the order of their distances. It is good at primitives of one size that fill
// their box, such as height fields. It is bad at a small object in a large scene, which lies in few cells, and at empty space,
// through which a ray goes cell by cell.
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

#include "clarity_space/primitives.hpp"
#include "clarity_space/tree.hpp"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "grid_types.h"

namespace {

using clarity::space::is_huge;
using clarity::space::kEps;
using clarity::space::TrianglePlane;

enum Param { kDensity, kExact };
constexpr rt_param kParams[] = {
    rt::float_param("density", "Density", "cells for each primitive", 0.1, 64, 5),
    rt::bool_param("exact", "Exact", "a triangle is in the cells that its plane meets; else in all that its box meets", true),
};

// The grid of one group, as it is built.
class Grid {
 public:
    grid_head head{{0, 0, 0, 0, 0, 0}, {1, 1, 1}, {1, 1, 1}, 0, {0, 0, 0}};
    std::vector<rt_u32> starts, list;
    uint64_t filled = 0;  // cells with primitives

    Grid(const rt_build_input& in, const rt_group& group)
        : prims_(in.prims + group.first),
          count_(group.count),
          triangles_(in.geometry->triangles),
          exact_(triangles_ && in.params[kExact] != 0) {
        set_shape(in.params[kDensity]);
    }

    // first: position of the group's first primitive in leaf order. Counts the primitives of each cell, then places them.
    void fill(const rt_host* host, rt_u32 first) {
        const size_t cells = size_t{head.cells[0]} * head.cells[1] * head.cells[2];
        std::vector<uint64_t> ends(cells + 2);
        for (rt_u32 i = 0; i < count_; ++i) each_cell(host, i, cells, [&](size_t cell) { ++ends[cell + 1]; });
        for (size_t cell = 0; cell <= cells; ++cell) filled += ends[cell + 1] > 0, ends[cell + 1] += ends[cell];
        if (ends.back() > 0xFFFFFFF0u) throw rt::fail(host, "the cells name more than 2^32 primitives: lower `density`");
        starts.assign(ends.begin(), ends.end());
        list.resize(ends.back());
        for (rt_u32 i = 0; i < count_; ++i) each_cell(host, i, cells, [&](size_t cell) { list[ends[cell]++] = first + i; });
    }

 private:
    const rt_prim* prims_;
    rt_u32 count_;
    const rt_packed_prim* triangles_;
    bool exact_;
    double slack_[3] = {};  // the planes and divisions of kernels round by 6 * 2^-24 of the largest coordinate in all

    void set_shape(double density) {
        double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY}, extent[3];
        rt_u32 inside = 0;
        for (rt_u32 i = 0; i < count_; ++i) {
            if (is_huge(prims_[i])) continue;
            ++inside;
            for (int k = 0; k < 3; ++k)
                lo[k] = std::min(lo[k], double{prims_[i].lo[k]}), hi[k] = std::max(hi[k], double{prims_[i].hi[k]});
        }
        if (inside == 0) return;
        for (int k = 0; k < 3; ++k) {
            slack_[k] = 16 * kEps * std::max(std::fabs(lo[k]), std::fabs(hi[k])) + 1e-30;
            head.box[k] = float(lo[k] - 2 * slack_[k]);
            head.box[k + 3] = float(hi[k] + 2 * slack_[k]);
            extent[k] = double{head.box[k + 3]} - head.box[k];
        }
        // Cells as cubic as can be, `density` times as many as primitives. An axis along which the box is thinner than a cell
        // has one, and the others share the cells.
        bool thin[3] = {false, false, false};
        for (int round = 0; round < 3; ++round) {
            double volume = 1, axes = 0;
            for (int k = 0; k < 3; ++k)
                if (!thin[k]) volume *= extent[k], ++axes;
            const double a_unit = axes > 0 ? std::pow(density * inside / volume, 1 / axes) : 0;
            for (int k = 0; k < 3; ++k) {
                const double most = std::min(4096.0, extent[k] / (8 * slack_[k]));
                head.cells[k] = thin[k] ? 1 : rt_u32(std::clamp(extent[k] * a_unit, 1.0, std::max(most, 1.0)));
                thin[k] = thin[k] || extent[k] * a_unit < 1;
            }
        }
        for (int k = 0; k < 3; ++k) head.size[k] = float(extent[k] / head.cells[k]);
    }

    // Calls body with each cell that primitive i meets.
    template <class Body>
    void each_cell(const rt_host* host, rt_u32 i, size_t cells, const Body& body) const {
        if (i % 4096 == 0) rt::progress(host, float(i) / float(count_));
        const rt_prim& p = prims_[i];
        if (is_huge(p)) return body(cells);
        int lo[3], hi[3];
        for (int k = 0; k < 3; ++k) {
            const double most = head.cells[k] - 1.0;
            lo[k] = int(std::clamp((p.lo[k] - slack_[k] - head.box[k]) / head.size[k], 0.0, most));
            hi[k] = int(std::clamp((p.hi[k] + slack_[k] - head.box[k]) / head.size[k], 0.0, most));
        }
        const auto index = [&](int x, int y, int z) {
            return (size_t(z) * head.cells[1] + size_t(y)) * head.cells[0] + size_t(x);
        };
        const bool flat = (hi[0] > lo[0]) + (hi[1] > lo[1]) + (hi[2] > lo[2]) < 2;  // then its plane hardly misses a cell
        if (flat || !exact_ || RT_REF_KIND(p.ref) != RT_REF_TRIANGLE) {
            for (int z = lo[2]; z <= hi[2]; ++z)
                for (int y = lo[1]; y <= hi[1]; ++y)
                    for (int x = lo[0]; x <= hi[0]; ++x) body(index(x, y, z));
            return;
        }
        const TrianglePlane plane(triangles_[RT_REF_INDEX(p.ref)]);
        double half[3], center[3];
        for (int k = 0; k < 3; ++k) half[k] = 0.5 * head.size[k] + slack_[k];
        for (int z = lo[2]; z <= hi[2]; ++z)
            for (int y = lo[1]; y <= hi[1]; ++y)
                for (int x = lo[0]; x <= hi[0]; ++x) {
                    const int at[3] = {x, y, z};
                    for (int k = 0; k < 3; ++k) center[k] = head.box[k] + (at[k] + 0.5) * double{head.size[k]};
                    if (plane.meets(center, half)) body(index(x, y, z));
                }
    }
};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    const rt_u32 count = clarity::space::primitive_count(host, *in);
    std::vector<rt_u32> firsts;
    std::vector<Grid> grids;
    rt_u32 first = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        firsts.push_back(first);
        first += in->groups[g].count;
        grids.emplace_back(*in, in->groups[g]);
    }
    rt::parallel_for(host, in->group_count, [&](rt_u32 g) { grids[g].fill(host, firsts[g]); });

    uint64_t starts = 0, references = 0, filled = 0;
    for (Grid& grid : grids) {
        grid.head.first = rt_u32(starts);
        starts += grid.starts.size(), references += grid.list.size(), filled += grid.filled;
    }
    if (starts > 0xFFFFFFF0u || references > 0xFFFFFFF0u) throw rt::fail(host, "needs more than 2^32 cells: lower `density`");
    auto* const heads = rt::alloc<grid_head>(out, 0, in->group_count);
    auto* start = rt::alloc<rt_u32>(out, 1, starts);
    auto* list = rt::alloc<rt_u32>(out, 2, references);
    clarity::space::put_leaves(*in, out, count);
    for (rt_u32 g = 0, before = 0; g < in->group_count; ++g) {
        heads[g] = grids[g].head;
        for (const rt_u32 s : grids[g].starts) *start++ = before + s;
        list = std::copy(grids[g].list.begin(), grids[g].list.end(), list);
        before += rt_u32(grids[g].list.size());
        rt::root(out, g, g);
    }
    rt::stat(out, "nodes", double(starts - 2 * in->group_count));
    rt::stat(out, "leaves", double(filled));
    rt::stat(out, "references", double(references));
    return RT_OK;
}

// Level 0 is the box, level 1 the cells with primitives. Primitives that are too large for cells may be anywhere: each level
// then has all of space, too.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const grid_head& grid = static_cast<const grid_head*>(built->slots[0])[built->roots[group]];
    const rt_u32* const starts = static_cast<const rt_u32*>(built->slots[1]) + grid.first;
    const rt_u32 cells = grid.cells[0] * grid.cells[1] * grid.cells[2];
    if (level != RT_LEVEL_BOTTOM && level > 1) return RT_OK;
    if (starts[cells + 1] > starts[cells]) {
        const float lo[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX}, hi[3] = {FLT_MAX, FLT_MAX, FLT_MAX};
        sink->box(sink->ctx, lo, hi);
    }
    if (level == 0 && starts[cells] > starts[0]) sink->box(sink->ctx, grid.box, grid.box + 3);
    for (rt_u32 cell = 0; level != 0 && cell < cells; ++cell) {
        if (starts[cell + 1] == starts[cell]) continue;
        const rt_u32 at[3] = {cell % grid.cells[0], cell / grid.cells[0] % grid.cells[1], cell / grid.cells[0] / grid.cells[1]};
        float lo[3], hi[3];
        for (int k = 0; k < 3; ++k) {
            lo[k] = std::fma(float(at[k]), grid.size[k], grid.box[k]);
            hi[k] = at[k] + 1 == grid.cells[k] ? grid.box[k + 3] : std::fma(float(at[k] + 1), grid.size[k], grid.box[k]);
        }
        sink->box(sink->ctx, lo, hi);
    }
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "grid.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<grid_head>("grid_heads", "grid_head"), rt::slot<rt_u32>("grid_starts", "uint"),
                              rt::slot<rt_u32>("grid_list", "uint")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "grid_types.h"), rt::file(kFiles, "grid.cl"), rt::guarded<build>,
                                      rt::guarded<levels>, rt::Traits().can(RT_TRAVERSES_SINGLE_RAYS));
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin(
    "grid", "Uniform grid", "1.0.0", "Fujimoto, Tanaka, Iwata 1986, ARTS: Accelerated Ray-Tracing System", kParams, kAccel);
