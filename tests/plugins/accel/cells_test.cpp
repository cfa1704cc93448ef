// cells_test.cpp -- structures that part space: each point of a triangle is in a cell that names the triangle. The points are
// samples, and the cells are found by this test's own arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "harness.hpp"
// need the types of rt_shared.h, so they must follow the headers above:
#include "bsp_types.h"
#include "grid2_types.h"
#include "grid_types.h"
#include "kdtree_types.h"
#include "octree_types.h"

using namespace accel_test;

namespace {

// Slanted triangles of many sizes between -size and size, about `middle`.
Input shards(uint32_t count, float size, float middle) {
    std::mt19937 random(11);
    const auto number = [&](float reach) { return reach * (static_cast<float>(random() % 20001) / 10000 - 1); };
    Input input;
    std::vector<rt_prim> group;
    for (rt_u32 i = 0; i < count; ++i) {
        rt_packed_prim t{};
        t.ref = i;
        const float reach = size * (i % 16 == 0 ? 0.5f : 0.05f);
        float lo[3], hi[3];
        for (int k = 0; k < 3; ++k) {
            t.a[k] = middle + number(size);
            t.b[k] = t.a[k] + number(reach), t.c[k] = t.a[k] + number(reach);
            lo[k] = std::min({t.a[k], t.b[k], t.c[k]}), hi[k] = std::max({t.a[k], t.b[k], t.c[k]});
        }
        input.triangles.push_back(t);
        group.push_back(box_prim(lo, hi, i));
    }
    input.add_group(group);
    return input;
}

// Calls body with points of each triangle, its corners among them.
template <class Body>
void each_point(const Input& input, const Body& body) {
    for (const rt_packed_prim& t : input.triangles)
        for (int i = 0; i <= 12; ++i)
            for (int j = 0; i + j <= 12; ++j) {
                double p[3];
                for (int k = 0; k < 3; ++k)
                    p[k] = t.a[k] + (double{t.b[k]} - t.a[k]) * (i / 12.0) + (double{t.c[k]} - t.a[k]) * (j / 12.0);
                body(p, t.ref);
            }
}

// Whether a point is in the box that a cell notes for one of its names, in parts of the cell (cl/lanes/cell_parts.h).
bool is_in_parts(const grid_head& grid, const size_t* at, rt_u32 parts, const double* p) {
    for (int k = 0; k < 3; ++k) {
        const double part = ((p[k] - grid.box[k]) / grid.size[k] - double(at[k])) * 32, slack = 1e-5 * 32;  // of the points
        const rt_u32 first = parts >> (10 * k) & 31, last = parts >> (10 * k + 5) & 31;
        if (part < first - slack || part > last + 1 + slack) return false;
    }
    return true;
}

uint64_t points_lost_by_grid(const Input& input, const Built& built) {
    const grid_head& grid = built.slot<grid_head>()[built.roots[0]];
    const rt_u32 *starts = built.slot<rt_u32>(1) + grid.first, *list = built.slot<rt_u32>(2), *parts = built.slot<rt_u32>(4);
    const uint64_t* const blocks = built.slot<uint64_t>(3) + grid.first_block;
    uint64_t lost = 0;
    each_point(input, [&](const double* p, rt_u32 ref) {
        size_t at[3], across[3];
        for (int k = 0; k < 3; ++k) {
            at[k] = size_t(std::clamp((p[k] - grid.box[k]) / grid.size[k], 0.0, grid.cells[k] - 1.0));
            across[k] = (grid.cells[k] + 3) / 4;
        }
        const size_t cell = (at[2] * grid.cells[1] + at[1]) * grid.cells[0] + at[0];
        bool found = false;
        for (rt_u32 i = starts[cell]; i < starts[cell + 1]; ++i)
            found = found || (built.leaves[list[i]] == ref && is_in_parts(grid, at, parts[i], p));
        const uint64_t block = blocks[(at[2] / 4 * across[1] + at[1] / 4) * across[0] + at[0] / 4];
        lost += !found || (block >> (at[0] % 4 + 4 * (at[1] % 4) + 16 * (at[2] % 4)) & 1) == 0;
    });
    return lost;
}

// Whether a leaf below the node that holds the point names the triangle. A point in a plane is in both halves.
bool is_named(const Built& built, rt_u32 at, const double* p, rt_u32 ref) {
    const kdtree_node& node = built.slot<kdtree_node>(1)[at];
    const rt_u32 axis = node.code & 3u, rest = node.code >> 2;
    if (axis == KDTREE_LEAF) {
        const rt_u32* const list = built.slot<rt_u32>(2) + node.at.first;
        return std::any_of(list, list + rest, [&](rt_u32 i) { return built.leaves[i] == ref; });
    }
    const double slack = 1e-6 * (1 + std::fabs(p[axis]));  // of the points
    return (p[axis] <= node.at.split + slack && is_named(built, rest, p, ref)) ||
           (p[axis] >= node.at.split - slack && is_named(built, rest + 1, p, ref));
}

uint64_t points_lost_by_kdtree(const Input& input, const Built& built) {
    uint64_t lost = 0;
    each_point(input, [&](const double* p, rt_u32 ref) {
        lost += !is_named(built, built.slot<kdtree_head>()[built.roots[0]].node, p, ref);
    });
    return lost;
}

bool is_named_by_bsp(const Built& built, rt_u32 at, const double* p, rt_u32 ref) {
    const bsp_node& node = built.slot<bsp_node>(1)[at];
    const rt_u32 k = node.code & BSP_LEAF, rest = node.code >> 4;
    if (k == BSP_LEAF) {
        const rt_u32* const list = built.slot<rt_u32>(2) + node.at.first;
        return std::any_of(list, list + rest, [&](rt_u32 i) { return built.leaves[i] == ref; });
    }
    const double x = BSP_COMPONENT(BSP_XS, k) * p[0], y = BSP_COMPONENT(BSP_YS, k) * p[1], z = BSP_COMPONENT(BSP_ZS, k) * p[2];
    const double above = x + y + z - node.at.split, slack = 1e-6 * (1 + std::fabs(x) + std::fabs(y) + std::fabs(z));
    return (above <= slack && is_named_by_bsp(built, rest, p, ref)) ||
           (above >= -slack && is_named_by_bsp(built, rest + 1, p, ref));
}

// Each leaf names what lies in it, and oblique planes leave fewer triangles in a leaf than those of axes alone.
TEST(Bsp, NamesATriangleInEachLeafThatItMeets) {
    for (const float middle : {0.0f, 1000.0f}) {
        const Input input = shards(600, 1, middle);
        double in_a_leaf[2];
        for (const int oblique : {0, 1}) {
            const Built built = build(load("bsp"), input, {{{"directions", oblique ? 13.0 : 3.0}}, 2, {}});
            ASSERT_EQ(built.status, RT_OK) << built.why;
            uint64_t lost = 0;
            each_point(input, [&](const double* p, rt_u32 ref) {
                lost += !is_named_by_bsp(built, built.slot<bsp_head>()[built.roots[0]].node, p, ref);
            });
            EXPECT_EQ(lost, 0u) << middle;
            in_a_leaf[oblique] = built.stats.at("references") / built.stats.at("leaves");
        }
        EXPECT_LT(in_a_leaf[1], in_a_leaf[0]);
    }
}

bool is_named_by_octree(const Built& built, rt_u32 at, const double* p, rt_u32 ref) {
    const octree_node& node = built.slot<octree_node>(1)[at];
    if (node.code & OCTREE_LEAF) {
        const rt_u32* const list = built.slot<rt_u32>(2) + node.at.first;
        return std::any_of(list, list + (node.code & ~OCTREE_LEAF), [&](rt_u32 i) { return built.leaves[i] == ref; });
    }
    rt_u32 child = node.code;
    for (int k = 0; k < 3; ++k) child += p[k] > node.at.center[k] ? 1u << k : 0u;
    return is_named_by_octree(built, child, p, ref);
}

TEST(Octree, NamesATriangleInEachLeafThatItMeets) {
    for (const float middle : {0.0f, 1000.0f}) {
        const Input input = shards(2000, 1, middle);
        const Built built = build(load("octree"), input);
        ASSERT_EQ(built.status, RT_OK) << built.why;
        EXPECT_GT(built.stats.at("depth"), 3);
        uint64_t lost = 0;
        each_point(input, [&](const double* p, rt_u32 ref) {
            lost += !is_named_by_octree(built, built.slot<octree_head>()[built.roots[0]].node, p, ref);
        });
        EXPECT_EQ(lost, 0u) << middle;
        EXPECT_GT(built.defines.at("OCTREE_STACK"), 7 * built.stats.at("depth"));
    }
}

// What lies in one place cannot be parted: one leaf, and no cells without end.
TEST(Octree, EndsWherePartingGainsNothing) {
    std::vector<rt_prim> prims;
    for (rt_u32 i = 0; i < 500; ++i) prims.push_back(cube(0, 0, 0, 1, i));
    EXPECT_EQ(build(load("octree"), one_group(prims)).stats.at("nodes"), 1);
}

TEST(Grid, NamesATriangleInEachCellThatItMeets) {
    for (const float middle : {0.0f, 1000.0f})
        for (const double exact : {0.0, 1.0}) {
            const Input input = shards(2000, 1, middle);
            const Built built = build(load("grid"), input, {{{"exact", exact}}, 2, {}});
            ASSERT_EQ(built.status, RT_OK) << built.why;
            EXPECT_EQ(points_lost_by_grid(input, built), 0u) << middle << ", " << exact;
        }
}

TEST(Grid, LeavesOutCellsThatOnlyTheBoxMeets) {
    const Input input = shards(2000, 1, 0);
    const Built boxes = build(load("grid"), input, {{{"density", 5.0}, {"exact", 0.0}}, 2, {}}),
                exact = build(load("grid"), input, {{{"density", 5.0}}, 2, {}});
    EXPECT_LT(exact.stats.at("references"), 0.7 * boxes.stats.at("references"));
}

TEST(Grid, HasAsManyCellsAsAsked) {
    for (const double density : {1.0, 8.0}) {
        const Built built = build(load("grid"), one_group(scattered(20000, 10, 0, 3)), {{{"density", density}}, 2, {}});
        EXPECT_NEAR(built.stats.at("nodes") / (density * 20000), 1, 0.1);
    }
    // Primitives in a plane get one layer of cells.
    std::vector<rt_prim> floor = scattered(20000, 10, 0, 3);
    for (rt_prim& p : floor) p.lo[1] = p.hi[1] = 2;
    const Built built = build(load("grid"), one_group(floor), {{{"density", 5.0}}, 2, {}});
    EXPECT_EQ(built.slot<grid_head>()[0].cells[1], 1u);
    EXPECT_NEAR(built.stats.at("nodes") / (5.0 * 20000), 1, 0.1);
}

TEST(Grid, KeepsHugePrimitivesApart) {
    std::vector<rt_prim> prims = scattered(100, 10, 0, 3);
    const float lo[3] = {-INFINITY, -1, -1}, hi[3] = {INFINITY, 1, 1};
    prims.push_back(box_prim(lo, hi, 100));
    const Built built = build(load("grid"), one_group(prims), {{{"density", 3.0}}, 2, {}});
    ASSERT_EQ(built.status, RT_OK) << built.why;
    const grid_head& grid = built.slot<grid_head>()[0];
    const rt_u32 cells = grid.cells[0] * grid.cells[1] * grid.cells[2], *starts = built.slot<rt_u32>(1) + grid.first;
    ASSERT_EQ(starts[cells + 1] - starts[cells], 1u);
    EXPECT_EQ(built.leaves[built.slot<rt_u32>(2)[starts[cells]]], 100u);
    EXPECT_GT(cells, 100u) << "it does not stretch the grid";
}

// The number of a grid's cell that holds the point, or of the nearest one.
size_t cell_at(const grid2_grid& grid, const double* p) {
    size_t at[3];
    for (int k = 0; k < 3; ++k) at[k] = size_t(std::clamp((p[k] - grid.box[k]) / grid.size[k], 0.0, grid.cells[k] - 1.0));
    return grid.first + (at[2] * grid.cells[1] + at[1]) * grid.cells[0] + at[0];
}

bool is_named_by_grid2(const Built& built, const double* p, rt_u32 ref) {
    const auto* const grids = built.slot<grid2_grid>();
    const auto* const cells = built.slot<rt_u32>(1);
    const rt_u32 number = cells[cell_at(grids[built.roots[0]], p)];
    if (number == RT_NONE) return false;
    const grid2_grid& fine = grids[number];
    for (int k = 0; k < 3; ++k)
        if (p[k] < fine.box[k] || p[k] > fine.box[k + 3]) return false;
    const size_t cell = cell_at(fine, p);
    const rt_u32* const list = built.slot<rt_u32>(2);
    return std::any_of(list + cells[cell], list + cells[cell + 1], [&](rt_u32 i) { return built.leaves[i] == ref; });
}

TEST(Grid2, NamesATriangleInEachCellThatItMeets) {
    for (const float middle : {0.0f, 1000.0f}) {
        const Input input = shards(2000, 1, middle);
        const Built built = build(load("grid2"), input);
        ASSERT_EQ(built.status, RT_OK) << built.why;
        uint64_t lost = 0;
        each_point(input, [&](const double* p, rt_u32 ref) { lost += !is_named_by_grid2(built, p, ref); });
        EXPECT_EQ(lost, 0u) << middle;
    }
}

// A ball of many primitives in a large room: a uniform grid has it in one cell. Cells without primitives have no grid.
TEST(Grid2, GivesSmallThingsSmallCells) {
    std::vector<rt_prim> prims = scattered(5000, 0.01f, 0, 3);
    for (const float at : {-100.0f, 100.0f}) prims.push_back(cube(at, at, at, 1, rt_u32(prims.size())));
    const Built one = build(load("grid"), one_group(prims)), two = build(load("grid2"), one_group(prims));
    ASSERT_EQ(two.status, RT_OK) << two.why;
    EXPECT_LT(one.stats.at("leaves"), 20);
    EXPECT_GT(two.stats.at("leaves"), 2000);
    const grid2_grid& coarse = two.slot<grid2_grid>()[two.roots[0]];
    const rt_u32 *const begin = two.slot<rt_u32>(1) + coarse.first, cells = coarse.cells[0] * coarse.cells[1] * coarse.cells[2];
    EXPECT_NEAR(cells / (0.12 * 5000), 1, 0.2);
    EXPECT_GT(std::count(begin, begin + cells, RT_NONE), 0.9 * cells);
}

TEST(Grid2, KeepsHugePrimitivesApart) {
    std::vector<rt_prim> prims = scattered(100, 10, 0, 3);
    const float lo[3] = {-INFINITY, -1, -1}, hi[3] = {INFINITY, 1, 1};
    prims.push_back(box_prim(lo, hi, 100));
    const Built built = build(load("grid2"), one_group(prims));
    ASSERT_EQ(built.status, RT_OK) << built.why;
    const auto* const grids = built.slot<grid2_grid>();
    const auto* const cells = built.slot<rt_u32>(1);
    const grid2_grid& coarse = grids[built.roots[0]];
    EXPECT_LT(coarse.box[3], 100) << "it does not stretch the grid";
    const grid2_grid& apart = grids[cells[coarse.first + coarse.cells[0] * coarse.cells[1] * coarse.cells[2]]];
    ASSERT_EQ(cells[apart.first + 2] - cells[apart.first + 1], 1u);
    EXPECT_EQ(built.leaves[built.slot<rt_u32>(2)[cells[apart.first + 1]]], 100u);
}

TEST(Kdtree, NamesATriangleInEachLeafThatItMeets) {
    for (const float middle : {0.0f, 1000.0f}) {
        const Input input = shards(9000, 1, middle);  // above 8192 in parallel, by bins, and below 2048 by all bounds
        const Built built = build(load("kdtree"), input);
        ASSERT_EQ(built.status, RT_OK) << built.why;
        EXPECT_EQ(points_lost_by_kdtree(input, built), 0u) << middle;
    }
}

// Mean number of primitives in the leaves around random points.
double crowd_at_points(const Built& built) {
    std::mt19937 random(5);
    double sum = 0;
    for (int i = 0; i < 4000; ++i) {
        float p[3];
        for (float& x : p) x = static_cast<float>(random() % 20001) / 10000 - 1;
        kdtree_node node = built.slot<kdtree_node>(1)[built.slot<kdtree_head>()[0].node];
        while ((node.code & 3u) != KDTREE_LEAF)
            node = built.slot<kdtree_node>(1)[(node.code >> 2) + (p[node.code & 3u] > node.at.split)];
        sum += node.code >> 2;
    }
    return sum / 4000;
}

TEST(Kdtree, CutsTriangles) {
    Input input = shards(2000, 1, 0);
    const Built cut = build(load("kdtree"), input);
    std::vector<rt_packed_prim>().swap(input.triangles);  // then only boxes are known
    const Built boxes = build(load("kdtree"), input);
    EXPECT_LT(crowd_at_points(cut), 0.6 * crowd_at_points(boxes));
}

// Two clusters with a gap: the first planes cut off the gap, so that a leaf without primitives is near the root.
TEST(Kdtree, CutsOffEmptySpace) {
    std::vector<rt_prim> prims = scattered(500, 1, 0, 3);
    for (rt_prim& p : scattered(500, 1, 0, 4)) {
        p.lo[0] += 20, p.hi[0] += 20, p.ref += 500;
        prims.push_back(p);
    }
    const Built built = build(load("kdtree"), one_group(prims));
    const auto* const nodes = built.slot<kdtree_node>(1);
    const rt_u32 root = built.slot<kdtree_head>()[0].node;
    const auto is_empty = [&](rt_u32 at) { return nodes[at].code == KDTREE_LEAF; };
    bool found = false;
    for (rt_u32 i = 0; i < 2; ++i) {
        const rt_u32 child = (nodes[root].code >> 2) + i;
        found = found || is_empty(child);
        if ((nodes[child].code & 3u) != KDTREE_LEAF)
            found = found || is_empty(nodes[child].code >> 2) || is_empty((nodes[child].code >> 2) + 1);
    }
    EXPECT_TRUE(found);
}

TEST(Kdtree, TheStackHoldsItsDepth) {
    const Built built = build(load("kdtree"), shards(3000, 1, 0));
    EXPECT_GT(built.defines.at("KDTREE_STACK"), built.stats.at("depth"));
    EXPECT_LE(build(load("kdtree"), shards(3000, 1, 0), {{{"max_depth", 5.0}}, 2, {}}).stats.at("depth"), 5);
}

TEST(Cells, TreesDoNotDependOnThreads) {
    const Input input = shards(20000, 1, 0);
    for (const char* id : {"grid", "grid2", "kdtree", "octree"}) {
        const Built one = build(load(id), input, {{}, 1, {}}), two = build(load(id), input, {{}, 3, {}});
        EXPECT_TRUE(same_tree(load(id), one, two)) << id;
        EXPECT_EQ(build(load(id), input, {{}, 1, [](float) { return false; }}).status, RT_CANCELLED) << id;
    }
}

}  // namespace
