// bounds_test.cpp -- boxes of placed meshes enclose the triangles that rays hit, however much large coordinates cancel.
#include <gtest/gtest.h>

#include <cmath>

#include "base/progress.hpp"
#include "structures/build_scene.hpp"
#include "support/generated.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

using Vec = std::array<double, 3>;

Vec transformed(const Affine& m, const Vec& p) {
    Vec r{};
    for (int k = 0; k < 3; ++k)
        r[k] = double(m[4 * k]) * p[0] + double(m[4 * k + 1]) * p[1] + double(m[4 * k + 2]) * p[2] + m[4 * k + 3];
    return r;
}

// A rotation about a slanted axis with a scale, which moves the point `center` to the world's origin as exactly as floats
// allow.
Affine brings_home(const Vec& center, double stretch) {
    const double turn[9] = {0.7071068, -0.5, 0.5, 0.5, 0.8535534, 0.1464466, -0.5, 0.1464466, 0.8535534};
    Affine m{};
    for (int k = 0; k < 3; ++k) {
        double moved = 0;
        for (int j = 0; j < 3; ++j) {
            m[4 * k + j] = static_cast<float>(stretch * turn[3 * k + j]);
            moved -= double(m[4 * k + j]) * center[j];
        }
        m[4 * k + 3] = static_cast<float>(moved);
    }
    return m;
}

// A small box at `center`, placed `copies` times by `place`.
Scene far_box(const Vec& center, const Affine& place, unsigned copies) {
    TriangleMesh mesh = box(2);
    mesh.transform(1, center);
    Scene scene = scene_of(mesh);
    scene.instances[0].world_from_object = place;
    for (unsigned i = 1; i < copies; ++i) scene.instances.push_back(scene.instances[0]);
    return scene;
}

void expect_within(const Vec& p, const float* lo, const float* hi, const std::string& what) {
    for (int k = 0; k < 3; ++k) {
        EXPECT_LE(double(lo[k]), p[k]) << what << ", axis " << k;
        EXPECT_GE(double(hi[k]), p[k]) << what << ", axis " << k;
    }
}

struct FarCase {
    Vec center;
    double stretch;
};
const FarCase kFarCases[] = {{{1e6, 1e6, 1e6}, 1},   {{-1e6, 1e6, 3e5}, 1},    {{1e6, -2e6, 1.5e6}, 0.01},
                             {{3e6, 1e5, -1e6}, 40}, {{1e5, -1e5, 1e5}, 1e-3}, {{7e4, 2e4, -9e4}, 1000},
                             {{0, 0, 0}, 1},         {{1e3, 1e3, -1e3}, 2}};

// In double precision a corner is at world_from_object times the corner. Rays see it where the float matrix object_from_world
// maps back to the corner. Both points must be inside.
TEST(Bounds, HoldInstancesWhoseLargeCoordinatesCancel) {
    for (const FarCase& c : kFarCases) {
        SCOPED_TRACE("centre " + std::to_string(c.center[0]) + ", stretch " + std::to_string(c.stretch));
        const Scene scene = far_box(c.center, brings_home(c.center, c.stretch), 2);
        Progress progress;
        const BuildScene built = make_build_scene(scene, progress);
        ASSERT_EQ(built.instances.size(), 2u);
        const rt_packed_prim& leaf = built.instance_leaves[0];
        const rt_prim& prim = built.prims[0];
        ASSERT_EQ(prim.ref, leaf.ref);
        const float* m = built.instances[0].object_from_world;
        for (size_t v = 0; v < scene.positions.size(); v += 3) {
            const Vec corner = {scene.positions[v], scene.positions[v + 1], scene.positions[v + 2]};
            const Vec world = transformed(scene.instances[0].world_from_object, corner);
            // Newton's method in double precision solves m x = corner.
            Vec seen = world;
            for (int step = 0; step < 3; ++step) {
                Affine inverse;
                std::copy_n(m, 12, inverse.begin());
                const Vec back = transformed(inverse, seen);
                for (int k = 0; k < 3; ++k)
                    for (int j = 0; j < 3; ++j)
                        seen[k] += double(scene.instances[0].world_from_object[4 * k + j]) * (corner[j] - back[j]);
            }
            for (const Vec& p : {world, seen}) {
                expect_within(p, prim.lo, prim.hi, "what the structure is built of");
                expect_within(p, leaf.a, leaf.b, "the instance's leaf");
                expect_within(p, built.bounds.min.data(), built.bounds.max.data(), "the scene's bounds");
            }
        }
    }
}

// Meshes that are placed once become triangles of the world: the boxes must enclose exactly the floats that are traced.
TEST(Bounds, HoldTheTracedCornersOfFlattenedMeshes) {
    for (const FarCase& c : kFarCases) {
        SCOPED_TRACE("centre " + std::to_string(c.center[0]) + ", stretch " + std::to_string(c.stretch));
        Progress progress;
        const BuildScene built = make_build_scene(far_box(c.center, brings_home(c.center, c.stretch), 1), progress);
        ASSERT_EQ(built.instances.size(), 0u);
        ASSERT_EQ(built.triangles.size(), 12u);
        for (size_t i = 0; i < built.triangles.size(); ++i) {
            const rt_packed_prim& leaf = built.triangles[i];
            ASSERT_EQ(built.prims[i].ref, leaf.ref);
            for (const float* corner : {leaf.a, leaf.b, leaf.c}) {
                const Vec p = {corner[0], corner[1], corner[2]};
                expect_within(p, built.prims[i].lo, built.prims[i].hi, "the triangle's box");
                expect_within(p, built.bounds.min.data(), built.bounds.max.data(), "the scene's bounds");
            }
        }
    }
}

// Where nothing cancels, a box must not grow.
TEST(Bounds, StayTightNearTheOrigin) {
    const Scene scene = far_box({0, 0, 0}, brings_home({0, 0, 0}, 1), 2);
    Progress progress;
    const BuildScene built = make_build_scene(scene, progress);
    for (int k = 0; k < 3; ++k) {
        double reach = 0;
        for (int j = 0; j < 3; ++j) reach += 2 * std::fabs(scene.instances[0].world_from_object[4 * k + j]);
        EXPECT_NEAR(built.bounds.max[k], reach, 2e-5);
        EXPECT_NEAR(built.bounds.min[k], -reach, 2e-5);
    }
}

}  // namespace
