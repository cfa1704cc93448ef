// cells.hpp -- the cells of a regular grid, and which of them a primitive meets. Header only, part of the SDK.
//
// Head is a grid as kernels know it, for cl/lanes/cells.h: box[6] with the lower corner first, size[3] of a cell, and their
// numbers cells[3] along x, y and z. Cell (x, y, z) is number (z * cells[1] + y) * cells[0] + x.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "clarity_space/primitives.hpp"

namespace clarity::space {

// The primitives of a group. Without triangles only their boxes are known.
struct Prims {
    const rt_prim* prims;
    const rt_packed_prim* triangles;
};

template <class Head>
size_t cell_count(const Head& head) {
    return size_t{head.cells[0]} * head.cells[1] * head.cells[2];
}

// How far the planes and divisions of kernels may be off: they round by 6 * 2^-24 of the largest coordinate in all.
template <class Head>
double cell_slack(const Head& head, int axis) {
    return 16 * kEps * std::max(std::fabs(head.box[axis]), std::fabs(head.box[axis + 3])) + 1e-30;
}

// Parts the box into cells, about `wanted` in all and as cubic as can be. An axis along which the box is thinner than a cell
// has one, and the others share the cells.
template <class Head>
void shape_cells(Head& head, const double lo[3], const double hi[3], double wanted) {
    double extent[3];
    for (int k = 0; k < 3; ++k) head.box[k] = float(lo[k]), head.box[k + 3] = float(hi[k]);
    for (int k = 0; k < 3; ++k) {
        const double slack = cell_slack(head, k);
        head.box[k] = float(lo[k] - 2 * slack);
        head.box[k + 3] = float(hi[k] + 2 * slack);
        extent[k] = double{head.box[k + 3]} - head.box[k];
    }
    bool thin[3] = {false, false, false};
    for (int round = 0; round < 3; ++round) {
        double volume = 1, axes = 0;
        for (int k = 0; k < 3; ++k)
            if (!thin[k]) volume *= extent[k], ++axes;
        const double a_unit = axes > 0 ? std::pow(wanted / volume, 1 / axes) : 0;
        for (int k = 0; k < 3; ++k) {
            const double most = std::min(4096.0, extent[k] / (8 * cell_slack(head, k)));
            head.cells[k] = thin[k] ? 1 : rt_u32(std::clamp(extent[k] * a_unit, 1.0, std::max(most, 1.0)));
            thin[k] = thin[k] || extent[k] * a_unit < 1;
        }
    }
    for (int k = 0; k < 3; ++k) head.size[k] = float(extent[k] / head.cells[k]);
}

// The box of a cell, as kernels compute its planes.
template <class Head>
void cell_box(const Head& head, size_t cell, float lo[3], float hi[3]) {
    const size_t at[3] = {cell % head.cells[0], cell / head.cells[0] % head.cells[1], cell / head.cells[0] / head.cells[1]};
    for (int k = 0; k < 3; ++k) {
        lo[k] = std::fma(float(at[k]), head.size[k], head.box[k]);
        hi[k] = at[k] + 1 == head.cells[k] ? head.box[k + 3] : std::fma(float(at[k] + 1), head.size[k], head.box[k]);
    }
}

// The cells that a primitive's box meets, along each axis.
struct CellRange {
    int lo[3], hi[3];
};
template <class Head>
CellRange cells_of_box(const Head& head, const rt_prim& p) {
    CellRange range;
    for (int k = 0; k < 3; ++k) {
        const double most = head.cells[k] - 1.0, slack = cell_slack(head, k);
        range.lo[k] = int(std::clamp((p.lo[k] - slack - head.box[k]) / head.size[k], 0.0, most));
        range.hi[k] = int(std::clamp((p.hi[k] + slack - head.box[k]) / head.size[k], 0.0, most));
    }
    return range;
}

// Calls body with the number of each cell that primitive i meets. Huge ones are in a cell of their own behind all others.
template <class Head, class Body>
void each_cell(const Head& head, const Prims& of, rt_u32 i, const Body& body) {
    const rt_prim& p = of.prims[i];
    if (is_huge(p)) return body(cell_count(head));
    const CellRange range = cells_of_box(head, p);
    const int *const lo = range.lo, *const hi = range.hi;
    const auto each = [&](const auto& meets) {
        for (int z = lo[2]; z <= hi[2]; ++z)
            for (int y = lo[1]; y <= hi[1]; ++y)
                for (int x = lo[0]; x <= hi[0]; ++x)
                    if (meets(x, y, z)) body((size_t(z) * head.cells[1] + size_t(y)) * head.cells[0] + size_t(x));
    };
    const bool flat = (hi[0] > lo[0]) + (hi[1] > lo[1]) + (hi[2] > lo[2]) < 2;  // then its plane hardly misses a cell
    if (flat || !of.triangles || RT_REF_KIND(p.ref) != RT_REF_TRIANGLE) return each([](int, int, int) { return true; });
    const TrianglePlane plane(of.triangles[RT_REF_INDEX(p.ref)]);
    double half[3];
    for (int k = 0; k < 3; ++k) half[k] = 0.5 * head.size[k] + cell_slack(head, k);
    each([&](int x, int y, int z) {
        const int at[3] = {x, y, z};
        double center[3];
        for (int k = 0; k < 3; ++k) center[k] = head.box[k] + (at[k] + 0.5) * double{head.size[k]};
        return plane.meets(center, half);
    });
}

// The primitives of all cells, cell by cell: those of cell c are list[starts[c]] to list[starts[c + 1] - 1]. Behind the last
// cell there is one more, of huge primitives.
struct CellLists {
    std::vector<rt_u32> starts, list;
    size_t filled = 0;  // cells with primitives
};

// Counts the primitives of each cell, then places them. number(i) is the group's number of primitive i of `count`.
template <class Head, class Number>
CellLists fill_cells(const rt_host* host, const Head& head, const Prims& of, rt_u32 count, const Number& number) {
    CellLists lists;
    const size_t cells = cell_count(head);
    std::vector<uint64_t> ends(cells + 2);
    for (rt_u32 i = 0; i < count; ++i) {
        if (i % 4096 == 0) rt::progress(host, float(i) / float(count));
        each_cell(head, of, number(i), [&](size_t cell) { ++ends[cell + 1]; });
    }
    for (size_t cell = 0; cell <= cells; ++cell) lists.filled += ends[cell + 1] > 0, ends[cell + 1] += ends[cell];
    if (ends.back() > 0xFFFFFFF0u) throw rt::fail(host, "the cells name more than 2^32 primitives: ask for fewer cells");
    lists.starts.assign(ends.begin(), ends.end());
    lists.list.resize(ends.back());
    for (rt_u32 i = 0; i < count; ++i)
        each_cell(head, of, number(i), [&](size_t cell) { lists.list[ends[cell]++] = number(i); });
    return lists;
}

// The bounds of the primitives that are not huge.
struct Extent {
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    rt_u32 count = 0;

    void add(const rt_prim& p) {
        if (is_huge(p)) return;
        ++count;
        for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], double{p.lo[k]}), hi[k] = std::max(hi[k], double{p.hi[k]});
    }
};

}  // namespace clarity::space
