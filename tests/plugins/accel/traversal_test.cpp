// traversal_test.cpp -- rays find the same hits in a tree as by testing everything. The primitives are the boxes themselves.
// The traversals are simple ones in double precision, written for this test; the kernels' traversals are tested on devices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bvh2_check.hpp"
#include "spheres_types.h"

using namespace accel_test;

namespace {

struct Ray {
    double o[3], d[3];
};

// Returns the distance at which the ray enters a box, or +inf if it misses.
double enter(const float* lo, const float* hi, const Ray& ray) {
    double in = 0, out = INFINITY;
    for (int a = 0; a < 3; ++a) {
        if (ray.d[a] == 0) {
            if (ray.o[a] < lo[a] || ray.o[a] > hi[a]) return INFINITY;
            continue;
        }
        const double t0 = (lo[a] - ray.o[a]) / ray.d[a], t1 = (hi[a] - ray.o[a]) / ray.d[a];
        in = std::max(in, std::min(t0, t1));
        out = std::min(out, std::max(t0, t1));
    }
    return in <= out ? in : INFINITY;
}

struct Scene {
    Input input;
    std::vector<uint32_t> by_ref;
    explicit Scene(const std::vector<rt_prim>& prims) {
        input.add_group(prims);
        by_ref.resize(prims.size());
        for (uint32_t i = 0; i < prims.size(); ++i) by_ref[prims[i].ref] = i;
    }
    double hit(rt_u32 ref, const Ray& ray) const {
        return enter(input.prims[by_ref[ref]].lo, input.prims[by_ref[ref]].hi, ray);
    }
    double brute(const Ray& ray) const {
        double t = INFINITY;
        for (const rt_prim& prim : input.prims) t = std::min(t, enter(prim.lo, prim.hi, ray));
        return t;
    }
};

double trace_bvh2(const Scene& scene, const Built& built, const Ray& ray, uint32_t& deepest) {
    double t = INFINITY;
    std::vector<rt_u32> stack{built.roots[0]};
    while (!stack.empty()) {
        deepest = std::max(deepest, static_cast<uint32_t>(stack.size()) - 1);
        const rt_u32 at = stack.back();
        stack.pop_back();
        if (at & BVH2_LEAF) {
            for (rt_u32 i = 0; i < BVH2_LEAF_COUNT(at); ++i)
                t = std::min(t, scene.hit(built.leaves[BVH2_LEAF_FIRST(at) + i], ray));
            continue;
        }
        const bvh2_node& node = built.slot<bvh2_node>()[at];
        const double t0 = enter(node.box0, node.box0 + 3, ray), t1 = enter(node.box1, node.box1 + 3, ray);
        if (std::max(t0, t1) <= t) stack.push_back(t0 <= t1 ? node.child1 : node.child0);
        if (std::min(t0, t1) <= t && std::min(t0, t1) < INFINITY) stack.push_back(t0 <= t1 ? node.child0 : node.child1);
    }
    return t;
}

double trace_spheres(const Scene& scene, const Built& built, const Ray& ray) {
    double t = INFINITY;
    const auto* nodes = built.slot<spheres_node>();
    for (rt_u32 at = built.roots[0] + 1; at < nodes[built.roots[0]].link;) {
        const spheres_node& node = nodes[at];
        double dd = 0, ld = 0, ll = 0;
        for (int a = 0; a < 3; ++a) {
            const double l = node.volume[a] - ray.o[a];
            dd += ray.d[a] * ray.d[a];
            ld += l * ray.d[a];
            ll += l * l;
        }
        const double r2 = double{node.volume[3]} * node.volume[3] * (1 + 1e-9), miss2 = ll - ld * ld / dd;
        const bool behind = ld < 0 && ll > r2;
        if (miss2 > r2 || behind) {
            at = node.count > 0 ? at + 1 : node.link;
            continue;
        }
        for (rt_u32 i = node.link; i < node.link + node.count; ++i) t = std::min(t, scene.hit(built.leaves[i], ray));
        ++at;
    }
    return t;
}

std::vector<Ray> rays(int count) {
    std::mt19937 random(12345);
    const auto uniform = [&] { return random() / 4294967296.0 * 2 - 1; };
    std::vector<Ray> result;
    for (int i = 0; i < count; ++i) {
        Ray ray{{2 * uniform(), 2 * uniform(), 2 * uniform()}, {}};
        for (int a = 0; a < 3; ++a) ray.d[a] = uniform() - ray.o[a];  // towards the middle of the scene
        if (i % 5 == 0) ray.d[i % 3] = 0;
        if (i % 7 == 0) ray.d[0] = ray.d[1] = 0;
        if (i % 11 == 0) ray.d[1] = ray.d[2] = 0;
        if (ray.d[0] == 0 && ray.d[1] == 0 && ray.d[2] == 0) ray.d[0] = 1;
        result.push_back(ray);
    }
    return result;
}

}  // namespace

class Traversal : public ::testing::TestWithParam<int> {
 protected:
    static std::vector<rt_prim> prims() {
        switch (GetParam()) {
            case 0:
                return scattered(3000, 2, 0, 8);
            case 1:
                return bumpy_sphere(30000);
            case 2:
                return scattered(1, 1, 0, 8);
            default: {
                std::vector<rt_prim> same = scattered(200, 1e-6f, 0, 8);  // nearly coincident
                return same;
            }
        }
    }
};

TEST_P(Traversal, FindsTheHitsThatTestingEveryPrimitiveFinds) {
    const Scene scene(prims());
    const Built bvh2 = build(load("bvh2"), scene.input), spheres = build(load("spheres"), scene.input);
    ASSERT_EQ(bvh2.status, RT_OK);
    ASSERT_EQ(spheres.status, RT_OK);
    uint32_t deepest = 0, hits = 0;
    for (const Ray& ray : rays(GetParam() == 1 ? 300 : 1000)) {
        const double t = scene.brute(ray);
        hits += t < INFINITY;
        ASSERT_EQ(trace_bvh2(scene, bvh2, ray, deepest), t);
        ASSERT_EQ(trace_spheres(scene, spheres, ray), t);
    }
    if (GetParam() < 2) {
        EXPECT_GT(hits, 50u);  // else the test would prove little
    }
    EXPECT_LT(deepest, bvh2.defines.at("BVH2_STACK"));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Traversal, ::testing::Values(0, 1, 2, 3));
