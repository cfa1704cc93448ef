// subdivide_test.cpp -- large models made by subdividing small ones.
#include "tools/bench/scenes/subdivide.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "support/generated.hpp"

namespace {

using namespace clarity;
using namespace clarity::bench;
using namespace clarity::test;

TriangleMesh mesh_of(const Scene& scene) {
    TriangleMesh mesh;
    mesh.positions = scene.positions.copy();
    mesh.triangles = scene.triangles.copy();
    return mesh;
}

TEST(Subdivide, ClosedMeshesStayClosedAndCountsGrowBySquares) {
    for (const TriangleMesh& base : {box(1), uv_sphere(2, 8, 5), torus(2, 0.5, 7, 5)})
        for (const unsigned n : {1u, 2u, 3u, 7u}) {
            const Scene fine = subdivide(scene_of(base), n);
            EXPECT_EQ(validate(fine), "");
            EXPECT_EQ(fine.triangle_count(), base.triangles.size() / 3 * n * n);
            EXPECT_TRUE(mesh_of(fine).is_closed()) << n;
        }
}

TEST(Subdivide, EveryVertexIsUsedAndSet) {
    const Scene fine = subdivide(scene_of(box(1)), 6);
    std::set<rt_u32> used(fine.triangles.begin(), fine.triangles.end());
    EXPECT_EQ(used.size(), fine.vertex_count());
    for (rt_u32 v = 0; v < fine.vertex_count(); ++v) {
        const float* p = &fine.positions[3 * size_t(v)];
        EXPECT_GT(std::fabs(p[0]) + std::fabs(p[1]) + std::fabs(p[2]), 0.5f) << v;  // no point was left at the origin
    }
}

TEST(Subdivide, SurfacesAreDisplacedNotFlat) {
    // On a side of a box, triangles split without displacement would leave all points in its plane.
    const Scene fine = subdivide(scene_of(box(1)), 16);
    size_t off = 0;
    for (size_t i = 0; i < fine.positions.size(); i += 3) {
        const double m =
            std::max({std::fabs(fine.positions[i]), std::fabs(fine.positions[i + 1]), std::fabs(fine.positions[i + 2])});
        off += std::fabs(m - 1) > 1e-3;
    }
    EXPECT_GT(off, fine.vertex_count() / 2);
}

TEST(Subdivide, InstancesAreFlattenedWithTheirMaterials) {
    Scene scene = scene_of(box(1));
    const rt_u32 red = add_material(scene, diffuse(1, 0, 0));
    Instance second = scene.instances[0];
    second.material = red;
    second.world_from_object[3] = 10;
    scene.instances.push_back(second);
    const Scene fine = subdivide(scene, 2);
    EXPECT_EQ(validate(fine), "");
    EXPECT_EQ(fine.instances.size(), 1u);
    EXPECT_EQ(fine.triangle_count(), 2u * 12 * 4);
    EXPECT_EQ(fine.triangle_materials.front(), 0u);
    EXPECT_EQ(fine.triangle_materials.back(), red);
    EXPECT_GT(fine.bounds().max[0], 10.5f);
}

}  // namespace
