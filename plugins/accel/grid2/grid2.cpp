// grid2.cpp -- a grid of grids for each group: Kalojanov, Billeter, Slusallek 2011, "Two-Level Grids for Ray Tracing on GPUs".
//
// A coarse cell takes 4 bytes, and 64 if it has primitives: it then has a fine grid, in a box around its primitives. A fine
// cell takes 4 bytes, and 4 for each primitive in it. The traversal needs no stack. A fine grid has as many cells as its
// primitives ask for. So small things in a large scene get small cells, and a ray crosses empty space in coarse steps: both are
// what a uniform grid is bad at. A build takes time in proportion to the primitives and cells. Where primitives of one size
// fill their box the coarse cells gain nothing, and `grid` is better.
#include <algorithm>
#include <cfloat>
#include <vector>

#include "clarity_space/cells.hpp"
#include "clarity_space/tree.hpp"
#include "rt_cost.hpp"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "grid2_types.h"

namespace {

using namespace clarity::space;

constexpr size_t kChunk = 256;  // coarse cells that one task fills
// In so many cells of a grid a primitive may be on average. Small ones are in 1 to 4. Without the limit, n large ones that lie
// over each other ask for n cells, each is in n^(2/3) of them, and both levels multiply that.
constexpr double kMostCells = 16;

enum Param { kCoarse, kFine, kExact };
constexpr rt_param kParams[] = {
    rt::float_param("coarse", "Coarse density", "coarse cells for each primitive", 0.001, 8, 0.12),
    rt::float_param("fine", "Fine density", "fine cells for each primitive of a coarse cell", 0.1, 64, 2.4),
    rt::bool_param("exact", "Exact", "a triangle is in the cells that its plane meets; else in all that its box meets", true),
};

// Grids, cells and list, as kernels have them. Numbers of grids, cells and places count from the first of these.
struct Grids {
    std::vector<grid2_grid> grids;
    std::vector<rt_u32> cells, list;
    uint64_t filled = 0, places = 0;  // fine cells with primitives; all cells, coarse ones too

    // Appends a fine grid of the primitives that `some` names.
    void add(const rt_host* host, grid2_grid grid, const Prims& prims, const rt_u32* some, rt_u32 count) {
        const CellSort<grid2_grid> sort(host, grid, prims, count, [&](rt_u32 i) { return some[i]; });
        const size_t cell = cells.size(), place = list.size();
        cells.resize(cell + sort.lists() + 1);
        list.resize(place + sort.references());
        filled += sort.write(host, &cells[cell], list.data() + place, rt_u32(place), 0);
        places += cell_count(grid);
        grid.first = rt_u32(cell);
        grids.push_back(grid);
    }
};

constexpr grid2_grid kOneCell{{0, 0, 0, 0, 0, 0}, {1, 1, 1}, {1, 1, 1}, 0, {0, 0, 0}};

// Estimates in how many cells a primitive is on average, by some of them: a plane meets about as many as its largest face has.
template <class Number>
double cells_of_each(const grid2_grid& grid, const Prims& prims, rt_u32 count, const Number& number) {
    const rt_u32 step = std::max(count / 256, 1u);
    const CellFinder<grid2_grid> finder(grid);
    double sum = 0, seen = 0;
    for (rt_u32 i = 0; i < count; i += step) {
        const rt_prim& p = prims.prims[number(i)];
        if (is_huge(p)) continue;
        const CellRange range = finder.range(p);
        double across[3];
        for (int k = 0; k < 3; ++k) across[k] = range.hi[k] - range.lo[k] + 1;
        sum += across[0] * across[1] * across[2] / *std::min_element(across, across + 3);
        ++seen;
    }
    return seen > 0 ? sum / seen : 0;
}

// Parts the box into `wanted` cells, or fewer where primitives are large.
template <class Number>
void shape(grid2_grid& grid, const Extent& box, double wanted, const Prims& prims, rt_u32 count, const Number& number) {
    for (;; wanted /= 4) {
        shape_cells(grid, box.lo, box.hi, wanted);
        if (cell_count(grid) == 1 || cells_of_each(grid, prims, count, number) <= kMostCells) return;
    }
}

// The grids of one group.
class Builder {
 public:
    grid2_grid coarse = kOneCell;
    std::vector<rt_u32> numbers;  // of the fine grid in each coarse cell, among those of `parts`; or RT_NONE
    std::vector<Grids> parts;

    void build(const rt_host* host, const rt_build_input& in, const rt_group& group) {
        const Prims prims{in.prims + group.first, in.params[kExact] != 0 ? in.geometry->triangles : nullptr};
        const Extent extent = extent_of(host, prims.prims, group.count);
        const auto all = [](rt_u32 i) { return i; };
        if (extent.count > 0) shape(coarse, extent, in.params[kCoarse] * extent.count, prims, group.count, all);
        const CellSort<grid2_grid> sort(host, coarse, prims, group.count, all);
        const size_t cells = sort.lists();  // with that of huge primitives, the last
        std::vector<rt_u32> starts(cells + 1), list(sort.references());
        sort.write(host, starts.data(), list.data(), 0, 0);
        parts.resize((cells + kChunk - 1) / kChunk);
        rt::parallel_for(host, rt_u32(parts.size()), [&](rt_u32 p) {
            for (size_t cell = p * kChunk; cell < std::min(cells, (p + 1) * kChunk); ++cell) {
                const rt_u32 first = starts[cell], count = starts[cell + 1] - first;
                if (count == 0) continue;
                const grid2_grid grid =
                    cell + 1 == cells ? kOneCell : fine_grid(prims, cell, &list[first], count, in.params[kFine]);
                parts[p].add(host, grid, prims, &list[first], count);
            }
        });
        numbers.resize(cells);
        for (size_t cell = 0, number = 0; cell < cells; ++cell)
            numbers[cell] = starts[cell + 1] > starts[cell] ? rt_u32(number++) : RT_NONE;
    }

    rt::Surfaces surfaces() const {
        const double whole = rt::surface_of(coarse.box);
        rt::Surfaces sums;
        add_cells(coarse, whole, sums);
        for (const Grids& part : parts)
            for (const grid2_grid& fine : part.grids) add_cells(fine, &part.cells[fine.first], whole, sums);
        return sums;
    }

 private:
    // The box of a fine grid holds what is in the cell of its primitives' boxes, so rays miss it where the cell is empty.
    grid2_grid fine_grid(const Prims& prims, size_t cell, const rt_u32* some, rt_u32 count, double density) const {
        Extent extent;
        for (rt_u32 i = 0; i < count; ++i) extent.add(prims.prims[some[i]]);
        float lo[3], hi[3];
        cell_box(coarse, cell, lo, hi);
        for (int k = 0; k < 3; ++k) {
            const double slack = cell_slack(coarse, k), low = lo[k] - slack, high = hi[k] + slack;
            extent.lo[k] = std::clamp(extent.lo[k], low, high);
            extent.hi[k] = std::clamp(extent.hi[k], low, high);
        }
        grid2_grid fine = kOneCell;
        shape(fine, extent, density * count, prims, count, [&](rt_u32 i) { return some[i]; });
        return fine;
    }
};

int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) {
    const rt_u32 count = primitive_count(host, *in);
    std::vector<Builder> groups(in->group_count);
    rt::parallel_for(host, in->group_count, [&](rt_u32 g) { groups[g].build(host, *in, in->groups[g]); });

    uint64_t grids = 0, cells = 0, references = 0, filled = 0, places = 0;
    for (const Builder& group : groups) {
        ++grids, cells += group.numbers.size(), places += group.numbers.size() - 1;
        for (const Grids& part : group.parts) {
            grids += part.grids.size(), cells += part.cells.size(), references += part.list.size();
            filled += part.filled, places += part.places;
        }
    }
    if (cells > 0xFFFFFFF0u || references > 0xFFFFFFF0u)
        throw rt::fail(host, "needs more than 2^32 cells: lower `coarse` or `fine`");
    auto* const grid = rt::alloc<grid2_grid>(out, 0, grids);
    auto* const cell = rt::alloc<rt_u32>(out, 1, cells);
    auto* const list = rt::alloc<rt_u32>(out, 2, references);
    put_leaves(host, *in, out, count);
    rt_u32 at = 0, place = 0, name = 0, first = 0;  // in these three arrays, and in leaf order
    rt::ExpectedCost expected;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        const Builder& group = groups[g];
        expected.add_group(in->groups[g].count, rt::surface_of(group.coarse.box), group.surfaces());
        rt::root(out, g, at);
        grid[at] = group.coarse;
        grid[at++].first = place;
        for (const rt_u32 number : group.numbers) cell[place++] = number == RT_NONE ? RT_NONE : at + number;
        for (const Grids& part : group.parts) {
            for (const grid2_grid& fine : part.grids) grid[at] = fine, grid[at++].first += place;
            for (const rt_u32 start : part.cells) cell[place++] = name + start;
            for (const rt_u32 prim : part.list) list[name++] = first + prim;
        }
        first += in->groups[g].count;
    }
    rt::stat(out, "nodes", double(places));
    rt::stat(out, "leaves", double(filled));
    rt::stat(out, "references", double(references));
    expected.report(out);
    return RT_OK;
}

// Level 0 is the box, level 1 the boxes of the fine grids, level 2 the fine cells with primitives. Primitives that are too
// large for cells may be anywhere: each level then has all of space, too.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink) {
    if (group >= built->group_count) throw rt::fail(host, "was asked for the levels of a group that the scene does not have");
    const auto* const grids = static_cast<const grid2_grid*>(built->slots[0]);
    const auto* const cells = static_cast<const rt_u32*>(built->slots[1]);
    const grid2_grid& coarse = grids[built->roots[group]];
    const size_t count = cell_count(coarse);
    if (level != RT_LEVEL_BOTTOM && level > 2) return RT_OK;
    if (cells[coarse.first + count] != RT_NONE) {
        const float lo[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX}, hi[3] = {FLT_MAX, FLT_MAX, FLT_MAX};
        sink->box(sink->ctx, lo, hi);
    }
    const rt_u32 *const begin = cells + coarse.first, *const end = begin + count;
    if (level == 0) {
        if (std::any_of(begin, end, [](rt_u32 number) { return number != RT_NONE; }))
            sink->box(sink->ctx, coarse.box, coarse.box + 3);
        return RT_OK;
    }
    for (const rt_u32* number = begin; number != end; ++number) {
        if (*number == RT_NONE) continue;
        const grid2_grid& fine = grids[*number];
        if (level == 1) sink->box(sink->ctx, fine.box, fine.box + 3);
        for (size_t i = 0; level != 1 && i < cell_count(fine); ++i) {
            float lo[3], hi[3];
            cell_box(fine, i, lo, hi);
            if (cells[fine.first + i + 1] > cells[fine.first + i]) sink->box(sink->ctx, lo, hi);
        }
    }
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "grid2.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<grid2_grid>("grid2_grids", "grid2_grid"), rt::slot<rt_u32>("grid2_cells", "uint"),
                              rt::slot<rt_u32>("grid2_list", "uint")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "grid2_types.h"), rt::file(kFiles, "grid2.cl"),
                                      rt::guarded<build>, rt::guarded<levels>, rt::Traits().can(RT_TRAVERSES_SINGLE_RAYS));
static_assert(sizeof(grid2_grid) == 64, "a grid to a cache line");
static_assert(kAccel.types.text && kAccel.traverse.text, "the kernel files are embedded");

}  // namespace

const rt_plugin rt_plugin_v1 =
    rt::accel_plugin("grid2", "Two-level grid", "1.0.0",
                     "Kalojanov, Billeter, Slusallek 2011, Two-Level Grids for Ray Tracing on GPUs", kParams, kAccel);
