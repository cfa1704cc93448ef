// spheres_test.cpp -- trees of bounding spheres: valid order, correct bounds, even halves, one tree per mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <set>
#include <sstream>

#include "harness.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "spheres_types.h"

using namespace accel_test;

namespace {

const rt_plugin& spheres() {
    static const rt_plugin* const plugin = &load("spheres");
    return *plugin;
}

// Walks the trees of a group, both as a traversal that enters every node and as trees.
class SpheresChecker {
 public:
    SpheresChecker(const Input& input, const Built& built, uint32_t max_leaf, uint32_t max_depth)
        : input_(input), built_(built), nodes_(built.slot<spheres_node>()), max_leaf_(max_leaf), max_depth_(max_depth) {
        for (uint32_t i = 0; i < input.prims.size(); ++i)
            if (input.prims[i].ref >= by_ref_.size()) by_ref_.resize(input.prims[i].ref + 1, RT_NONE);
        for (uint32_t i = 0; i < input.prims.size(); ++i) by_ref_[input.prims[i].ref] = i;
    }

    // roots: number of trees that follow the head of the group.
    uint32_t roots = 0, sphere_count = 0;
    std::multiset<uint32_t> leaf_sizes;

    std::string check(uint32_t group) {
        seen_.clear();
        const spheres_node& head = nodes_[built_.roots[group]];
        if (head.count != 0) return "the head has primitives";
        if (head.link > built_.slot_counts[0]) return "the group ends out of range";
        for (rt_u32 at = built_.roots[group] + 1; at < head.link; at = end_of(at)) {
            ++roots;
            std::set<uint32_t> meshes;
            const std::string why = visit(at, head.link, 0, meshes);
            if (!why.empty()) return why;
        }
        if (seen_.size() != input_.groups[group].count) return std::to_string(seen_.size()) + " primitives found";
        return {};
    }

 private:
    rt_u32 end_of(rt_u32 at) const { return nodes_[at].count > 0 ? at + 1 : nodes_[at].link; }
    // How far a point is outside of a node's volume.
    double outside(rt_u32 at, const double* p) const {
        const float* const v = nodes_[at].volume;
        const rt_u32 kind = *built_.slot<rt_u32>(2);
        double most = 0, square = 0;
        for (int a = 0; a < 3; ++a) {
            double along = 0;
            for (int k = 0; k < 3 && kind == SPHERES_ORIENTED; ++k)
                along += built_.slot<spheres_axes>(1)[at].axis[3 * a + k] * (p[k] - v[k]);
            if (kind == SPHERES_ORIENTED) most = std::max(most, std::fabs(along) - v[3 + a]);
            if (kind == SPHERES_BOX) most = std::max({most, v[a] - p[a], p[a] - v[3 + a]});
            square += (p[a] - v[a]) * (p[a] - v[a]);
        }
        return kind == SPHERES_SPHERE ? std::sqrt(square) - v[3] : most;
    }
    std::string visit(rt_u32 at, rt_u32 end, uint32_t level, std::set<uint32_t>& meshes) {
        const spheres_node& node = nodes_[at];
        std::ostringstream why;
        ++sphere_count;
        if (end_of(at) <= at || end_of(at) > end) why << "node " << at << " skips to " << end_of(at) << " of " << end;
        if (!why.str().empty()) return why.str();
        const size_t first_below = below_.size();
        if (node.count > 0) {
            leaf_sizes.insert(node.count);
            if (node.count > max_leaf_ && level < max_depth_) return "leaf of " + std::to_string(node.count);
            for (rt_u32 i = node.link; i < node.link + node.count; ++i) {
                if (i >= built_.leaves.size() || !seen_.insert(built_.leaves[i]).second)
                    return "position " + std::to_string(i) + " twice, or out of range";
                below_.push_back(by_ref_[built_.leaves[i]]);
                meshes.insert(input_.prims[below_.back()].mesh);
            }
        } else {
            const rt_u32 second = end_of(at + 1);
            if (second >= node.link || end_of(second) != node.link)
                return "node " + std::to_string(at) + " has not two children";
            for (const rt_u32 child : {at + 1, second}) {
                const std::string deeper = visit(child, node.link, level + 1, meshes);
                if (!deeper.empty()) return deeper;
            }
        }
        // Every corner of every triangle below is inside, or of its box where there is none.
        for (size_t b = first_below; b < below_.size(); ++b) {
            const rt_prim& prim = input_.prims[below_[b]];
            const bool boxes = input_.triangles.empty();
            for (int corner = 0; corner < (boxes ? 8 : 3); ++corner) {
                double p[3];
                for (int a = 0; a < 3; ++a) {
                    p[a] = corner >> a & 1 ? prim.hi[a] : prim.lo[a];
                    if (boxes) continue;
                    const rt_packed_prim& t = input_.triangles[RT_REF_INDEX(prim.ref)];
                    p[a] = (corner == 0 ? t.a : corner == 1 ? t.b : t.c)[a];
                }
                if (!(outside(at, p) <= 0)) return "node " + std::to_string(at) + " does not hold what is below";
            }
        }
        return {};
    }

    const Input& input_;
    const Built& built_;
    const spheres_node* nodes_;
    const uint32_t max_leaf_, max_depth_;
    std::vector<uint32_t> by_ref_, below_;
    std::set<rt_u32> seen_;
};

Input meshes(const std::vector<uint32_t>& sizes, float size = 1) {
    Input input;
    std::vector<rt_prim> prims;
    for (uint32_t m = 0; m < sizes.size(); ++m)
        for (rt_prim prim : scattered(sizes[m], size, 3.0f * size * static_cast<float>(m), m)) {
            prim.ref = static_cast<rt_u32>(prims.size());
            prim.mesh = m;
            prims.push_back(prim);
        }
    input.add_group(prims);
    return input;
}

void expect_spheres(const Input& input, const Built& built, uint32_t max_leaf = 4, uint32_t max_depth = 32) {
    ASSERT_EQ(built.status, RT_OK) << built.why;
    SpheresChecker checker(input, built, max_leaf, max_depth);
    for (uint32_t g = 0; g < input.groups.size(); ++g) EXPECT_EQ(checker.check(g), "") << "group " << g;
    EXPECT_EQ(checker.sphere_count + input.groups.size(), built.slot_counts[0]);
    EXPECT_EQ(built.stats.at("nodes"), built.slot_counts[0]);
    EXPECT_EQ(built.stats.at("leaves"), checker.leaf_sizes.size());
}

}  // namespace

TEST(Spheres, HoldEveryPrimitiveOnce) {
    for (const uint32_t count : {1u, 2u, 4u, 5u, 8u, 9u, 100u, 1023u, 3000u}) {
        const Input input = meshes({count});
        expect_spheres(input, build(spheres(), input));
    }
}

TEST(Spheres, KeepToTheirParameters) {
    const Input input = meshes({1000});
    for (const int max_leaf : {1, 2, 3, 7, 100, 256})
        expect_spheres(input, build(spheres(), input, {{{"max_leaf", max_leaf}}, 2, {}}), static_cast<uint32_t>(max_leaf));
    for (const int max_depth : {0, 1, 3}) {
        const Built built = build(spheres(), input, {{{"max_depth", max_depth}}, 2, {}});
        expect_spheres(input, built, 4, static_cast<uint32_t>(max_depth));
        EXPECT_EQ(built.stats.at("leaves"), 1 << max_depth);
    }
}

TEST(Spheres, SplitsIntoEqualHalves) {
    const Input input = meshes({1000});
    const Built built = build(spheres(), input, {{{"max_leaf", 8}}, 2, {}});
    SpheresChecker checker(input, built, 8, 32);
    ASSERT_EQ(checker.check(0), "");
    EXPECT_EQ(checker.leaf_sizes.size(), 128u);  // 1000 / 128 is 7.8, so all leaves have 7 or 8
    EXPECT_EQ(*checker.leaf_sizes.begin(), 7u);
    EXPECT_EQ(*checker.leaf_sizes.rbegin(), 8u);
}

TEST(Spheres, OneTreeForEachMeshAndNoneAbove) {
    Input input = meshes({100, 1, 50, 7});
    const Built built = build(spheres(), input);
    expect_spheres(input, built);
    SpheresChecker checker(input, built, 4, 32);
    ASSERT_EQ(checker.check(0), "");
    EXPECT_EQ(checker.roots, 4u);
    EXPECT_EQ(volumes(spheres(), built, 0, 0).size(), 4u);

    const Built above = build(spheres(), input, {{{"top_level", 1}}, 2, {}});
    expect_spheres(input, above);
    SpheresChecker with_top(input, above, 4, 32);
    ASSERT_EQ(with_top.check(0), "");
    EXPECT_EQ(with_top.roots, 1u);
    EXPECT_EQ(volumes(spheres(), above, 0, 0).size(), 1u);
    EXPECT_EQ(volumes(spheres(), above, 0, 2).size(), 4u);  // the roots of the meshes
}

TEST(Spheres, PrimitivesWithoutAMeshShareOneLeaf) {
    Input input;
    std::vector<rt_prim> prims = scattered(40, 1, 0, 1);
    for (rt_u32 i = 0; i < 30; ++i) {
        prims.push_back(scattered(1, 1, 0, 100 + i)[0]);
        prims.back().ref = RT_REF_SPHERE | i;
        prims.back().mesh = 1;
    }
    input.add_group(prims);
    const Built built = build(spheres(), input, {{{"lone_spheres", 1}}, 2, {}});
    ASSERT_EQ(built.status, RT_OK);
    const spheres_node* nodes = built.slot<spheres_node>();
    const rt_u32 head = built.roots[0], first = head + 1, second = nodes[first].link;
    EXPECT_EQ(nodes[second].count, 30u);
    EXPECT_GT(nodes[second].volume[3], 1e29f);
    EXPECT_EQ(nodes[head].link, second + 1);
    std::set<rt_u32> found;
    for (rt_u32 i = 0; i < 30; ++i) found.insert(built.leaves[nodes[second].link + i]);
    EXPECT_EQ(found.size(), 30u);
    for (const rt_u32 ref : found) EXPECT_EQ(RT_REF_KIND(ref), RT_REF_SPHERE);
    // The leaf that every ray enters bounds nothing, so it is not drawn.
    for (const Volume& volume : volumes(spheres(), built, 0, RT_LEVEL_BOTTOM)) EXPECT_LT(volume.radius, 10);
    // With a tree above the meshes, the spheres get a tree too.
    const Built above = build(spheres(), input, {{{"lone_spheres", 1}, {"top_level", 1}}, 2, {}});
    ASSERT_EQ(above.status, RT_OK);
    for (uint64_t i = 0; i < above.slot_counts[0]; ++i) EXPECT_LT(above.slot<spheres_node>()[i].volume[3], 10);
}

TEST(Spheres, GroupsMayBeEmptyOrMany) {
    Input input;
    input.add_group({});
    for (uint32_t g = 0; g < 300; ++g) input.add_group(scattered(g % 20, 1, 0, g));
    number(input);
    for (const double top_level : {0, 1}) {
        const Built built = build(spheres(), input, {{{"top_level", top_level}}, 2, {}});
        expect_spheres(input, built);
        EXPECT_EQ(built.slot<spheres_node>()[built.roots[0]].link, built.roots[0] + 1);
        EXPECT_TRUE(volumes(spheres(), built, 0, RT_LEVEL_BOTTOM).empty());
    }
}

TEST(Spheres, BoundsHoldDespiteRounding) {
    // Sizes and positions at which centres and radii are rounded.
    for (const float size : {1e-38f, 1e-10f, 1e10f, 1e30f}) {
        const Input input = meshes({500, 300}, size);
        expect_spheres(input, build(spheres(), input));
    }
    Input far;
    far.add_group(scattered(1000, 1, 1e7f, 4));
    expect_spheres(far, build(spheres(), far));
    Input same;
    same.add_group(std::vector<rt_prim>(1, far.prims[0]));
    for (uint32_t i = 1; i < 2000; ++i) {
        same.prims.push_back(far.prims[0]);
        same.prims.back().ref = i;
    }
    same.groups[0].count = 2000;
    expect_spheres(same, build(spheres(), same));
    Input broken = meshes({500});
    broken.prims[7].lo[1] = NAN;
    broken.prims[8].hi[2] = INFINITY;
    const Built built = build(spheres(), broken);
    EXPECT_EQ(built.status, RT_OK);
    for (size_t i = 0; i < built.slot_counts[0]; ++i) EXPECT_FALSE(std::isnan(built.slot<spheres_node>()[i].volume[3]));
}

TEST(Spheres, BuildTheSameTreeOnAnyNumberOfThreads) {
    Input input;
    input.add_group(bumpy_sphere(100000));
    const Built once = build(spheres(), input, {{}, 1, {}});
    for (const unsigned threads : {2u, 8u})
        EXPECT_TRUE(same_tree(spheres(), once, build(spheres(), input, {{}, threads, {}}))) << threads;
}

TEST(Spheres, StopWhenCancelled) {
    Input input;
    input.add_group(bumpy_sphere(200000));
    for (const int stop_at : {1, 4}) {
        int n = 0;
        EXPECT_EQ(build(spheres(), input, {{}, 2, [&](float) { return ++n < stop_at; }}).status, RT_CANCELLED);
    }
}

// The bumpy sphere, with its triangles.
Input of_triangles(uint32_t count) {
    std::vector<float> corners;
    Input input;
    input.add_group(bumpy_sphere(count, &corners));
    number(input);
    for (size_t i = 0; i < input.prims.size(); ++i) {
        rt_packed_prim t{};
        std::copy_n(&corners[9 * i], 3, t.a);
        std::copy_n(&corners[9 * i + 3], 3, t.b);
        std::copy_n(&corners[9 * i + 6], 3, t.c);
        t.ref = input.prims[i].ref;
        input.triangles.push_back(t);
    }
    return input;
}

// Half the surface of all volumes of the leaves.
double leaf_surface(const Built& built) {
    double sum = 0;
    for (const Volume& v : volumes(spheres(), built, 0, RT_LEVEL_BOTTOM)) {
        double side[3];
        for (int a = 0; a < 3; ++a) {
            const float* const h = v.halves + 3 * a;
            side[a] = v.halves[0] != 0 ? 2 * std::hypot(h[0], h[1], h[2]) : double(v.hi[a]) - v.lo[a];
        }
        sum += v.radius >= 0 ? 2 * 3.14159265 * v.radius * v.radius : side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
    }
    return sum;
}

TEST(Spheres, OtherVolumesAreInTheSameTreeAndTighter) {
    const Input input = of_triangles(3000);
    double before = INFINITY;
    std::vector<rt_u32> leaves;
    for (const int kind : {0, 1, 2}) {
        const Built built = build(spheres(), input, {{{"volume", kind}}, 2, {}});
        expect_spheres(input, built);
        EXPECT_EQ(built.slot_counts[1], kind == 2 ? built.slot_counts[0] : 0u);
        EXPECT_EQ(built.defines.at("SPHERES_VOLUME"), rt_u32(kind));
        if (kind > 0) {
            EXPECT_EQ(built.leaves, leaves);
        }
        leaves = built.leaves;
        const double surface = leaf_surface(built);
        EXPECT_LT(surface, 0.8 * before) << kind;
        before = surface;
        if (kind == 2) {
            EXPECT_GT(built.stats.at("turned boxes"), 0.9 * double(built.stats.at("leaves")));
        }
    }
}

TEST(Spheres, OtherVolumesHoldWhatIsNoTriangleAndWhatIsFlat) {
    for (const int kind : {1, 2}) {
        const Input input = meshes({1000, 1, 30});
        expect_spheres(input, build(spheres(), input, {{{"volume", kind}, {"top_level", 1}}, 2, {}}));
        Input flat = of_triangles(500);
        for (rt_packed_prim& t : flat.triangles)
            for (float* p : {t.a, t.b, t.c}) p[0] = 3 * p[1] - p[2];  // all in a plane, and some become lines
        for (size_t i = 0; i < flat.prims.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const rt_packed_prim& t = flat.triangles[i];
                flat.prims[i].lo[k] = std::min({t.a[k], t.b[k], t.c[k]});
                flat.prims[i].hi[k] = std::max({t.a[k], t.b[k], t.c[k]});
            }
        expect_spheres(flat, build(spheres(), flat, {{{"volume", kind}}, 2, {}}));
    }
}
