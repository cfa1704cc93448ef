// rays_test.cpp -- the rays of the ray benchmarks follow the convention, and their counters are correct.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/lowbias32.hpp"
#include "stand/ray_sets.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"
#include "tools/bench/baselines/baseline.hpp"
#include "tools/bench/cases/own_entries.hpp"
#include "view/settings/accel_choice.hpp"

namespace {

using namespace clarity;
using namespace clarity::bench;
using namespace clarity::test;

TEST(RayOrder, CoversEveryPixelOnceInBlocksOfPackets) {
    const int w = 37, h = 21;
    const std::vector<rt_u32> order = ray_order(w, h);
    EXPECT_EQ(order.size() % 256, 0u);
    std::set<rt_u32> seen;
    for (const rt_u32 pixel : order) EXPECT_TRUE(pixel == RT_NONE || seen.insert(pixel).second) << pixel;
    EXPECT_EQ(seen.size(), size_t(w) * h);
    EXPECT_EQ(*seen.rbegin(), rt_u32(w * h - 1));

    const std::vector<rt_u32> whole = ray_order(64, 48);
    const auto extent = [&](size_t first, size_t count, int& width, int& height) {
        int x0 = 64, x1 = 0, y0 = 48, y1 = 0;
        for (size_t i = first; i < first + count; ++i) {
            const int x = whole[i] % 64, y = whole[i] / 64;
            x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
        }
        width = x1 - x0 + 1, height = y1 - y0 + 1;
    };
    for (size_t first = 0; first < whole.size(); first += 16) {
        int width, height;
        extent(first, 16, width, height);
        EXPECT_EQ(width, 4);
        EXPECT_EQ(height, 4);
        extent(first, 8, width, height);
        EXPECT_EQ(width, 4);
        EXPECT_EQ(height, 2);
        extent(first, 4, width, height);
        EXPECT_EQ(width, 2);
        EXPECT_EQ(height, 2);
    }
}

// dir(x,y) = normalize(w + (2(x+.5)/W-1) tan(vfov/2) W/H u + (1-2(y+.5)/H) tan(vfov/2) v), y = 0 on top.
TEST(CameraRays, FollowTheCameraConvention) {
    Camera camera;
    camera.eye = {0, 0, 5};
    camera.target = {0, 0, 0};
    camera.fov_y_rad = float(M_PI / 2);
    const int w = 40, h = 20;
    const RaySet set = camera_rays(camera, w, h);
    EXPECT_EQ(set.active, uint64_t(w) * h);
    EXPECT_FALSE(set.any_hit);
    const std::vector<rt_u32> order = ray_order(w, h);
    for (size_t i = 0; i < order.size(); ++i) {
        const rt_ray& ray = set.rays[i];
        ASSERT_EQ(is_active(ray), order[i] != RT_NONE);
        if (!is_active(ray)) continue;
        const double x = order[i] % w, y = order[i] / w;  // camera axes: w = (0,0,-1), u = (1,0,0), v = (0,1,0); tangent 1
        const double dx = (2 * (x + 0.5) / w - 1) * 2, dy = 1 - 2 * (y + 0.5) / h, length = std::sqrt(dx * dx + dy * dy + 1);
        EXPECT_NEAR(ray.direction[0], dx / length, 1e-6);
        EXPECT_NEAR(ray.direction[1], dy / length, 1e-6);
        EXPECT_NEAR(ray.direction[2], -1 / length, 1e-6);
        EXPECT_EQ(ray.origin[2], 5.0f);
        EXPECT_EQ(ray.t_min, 0.0f);
        EXPECT_TRUE(std::isinf(ray.t_max));
    }
}

TEST(Hash, IsLowbias32) {
    EXPECT_EQ(lowbias32(0), 0u);
    // By hand: 1 * 0x7feb352d = 0x7feb352d; ^ >> 15 = 0x7febcafb; * 0x846ca68b; ^ >> 16.
    const uint32_t product = 0x7febcafbu * 0x846ca68bu;
    EXPECT_EQ(lowbias32(1), product ^ (product >> 16));
}

// A floor of two triangles at y = 1, seen obliquely from above; the light is above it.
struct Floor {
    Scene scene;
    RaySet primary;
    std::vector<rt_hit> hits;
    rt_light light{};
    static constexpr int kSize = 64;

    Floor() {
        TriangleMesh mesh;
        mesh.add_quad(Point{-9, 1, -9}, {9, 1, -9}, {9, 1, 9}, {-9, 1, 9});
        scene = scene_of(mesh);
        Camera camera;
        camera.eye = {0, 4, 6};
        camera.target = {0, 1, 0};
        primary = camera_rays(camera, kSize, kSize);
        light.position[0] = 3;
        light.position[1] = 7;
        for (const rt_ray& ray : primary.rays) {
            rt_hit hit{};
            hit.prim = -1;
            hit.t = INFINITY;
            const double t = (1.0 - ray.origin[1]) / ray.direction[1];
            if (is_active(ray) && t > 0 && std::fabs(ray.origin[2] + t * ray.direction[2]) < 9) {
                hit.t = float(t);
                hit.prim = 0;
            }
            hits.push_back(hit);
        }
    }
    std::vector<RaySet> secondary() const {
        return secondary_rays(scene, light, primary, kSize, kSize, [&](const auto&) { return hits; });
    }
};

TEST(SecondaryRays, StartAboveTheSurfaceInTheRightDirection) {
    const Floor floor;
    const auto sets = floor.secondary();
    ASSERT_EQ(sets.size(), 3u);
    uint64_t hit_count = 0;
    for (const rt_hit& hit : floor.hits) hit_count += hit.prim >= 0;
    ASSERT_GT(hit_count, 1000u);
    ASSERT_LT(hit_count, floor.primary.active);
    const double eps = 1e-4 * floor.scene.bounds().diagonal();
    double up = 0;
    for (size_t i = 0; i < floor.primary.rays.size(); ++i) {
        for (const RaySet& set : sets) ASSERT_EQ(is_active(set.rays[i]), floor.hits[i].prim >= 0) << set.kind;
        if (floor.hits[i].prim < 0) continue;
        const Vec in = to_vec(floor.primary.rays[i].direction);
        for (const RaySet& set : sets) {
            EXPECT_NEAR(set.rays[i].origin[1], 1 + eps, 2e-6) << set.kind;
            EXPECT_NEAR(dot(to_vec(set.rays[i].direction), to_vec(set.rays[i].direction)), 1, 1e-5) << set.kind;
        }
        const rt_ray &shadow = sets[0].rays[i], &mirror = sets[1].rays[i], &diffuse = sets[2].rays[i];
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(shadow.origin[k] + double(shadow.t_max) * shadow.direction[k], floor.light.position[k], 1e-4);
        EXPECT_NEAR(mirror.direction[0], in[0], 1e-6);
        EXPECT_NEAR(mirror.direction[1], -in[1], 1e-6);
        EXPECT_NEAR(mirror.direction[2], in[2], 1e-6);
        EXPECT_GT(diffuse.direction[1], 0);
        up += diffuse.direction[1];
    }
    EXPECT_TRUE(sets[0].any_hit);
    EXPECT_FALSE(sets[2].any_hit);
    EXPECT_EQ(sets[2].active, hit_count);
    // The mean cosine of cosine-weighted directions is 2/3.
    EXPECT_NEAR(up / double(hit_count), 2.0 / 3, 0.01);
}

TEST(SecondaryRays, InactiveRaysResembleTheirNeighbours) {
    const Floor floor;
    for (const RaySet& set : floor.secondary())
        for (size_t first = 0; first < set.rays.size(); first += 16) {
            std::set<std::array<float, 3>> directions;
            for (size_t i = first; i < first + 16; ++i)
                if (is_active(set.rays[i]))
                    directions.insert({set.rays[i].direction[0], set.rays[i].direction[1], set.rays[i].direction[2]});
            for (size_t i = first; i < first + 16 && !directions.empty(); ++i) {
                const float* d = set.rays[i].direction;
                EXPECT_TRUE(directions.count({d[0], d[1], d[2]})) << set.kind << " " << i;
            }
        }
}

// The renderer's primitive indices match those of SurfaceNormals: triangles of instances, spheres, polygons, planes.
TEST(SurfaceNormals, FaceTheRayOnEveryKindOfPrimitive) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const View view = make_view(*scene, 4.0f / 3);
    const RaySet primary = camera_rays(view.camera, 160, 120);
    Settings settings;
    const auto hits = Workbench::get().rays(scene, settings, primary.rays, false);
    settings.aov = "normal";
    settings.width = 160;
    settings.height = 120;
    const FloatImage truth = Workbench::get().values(scene, settings, view);
    const SurfaceNormals normals(*scene);
    const std::vector<rt_u32> order = ray_order(160, 120);
    size_t compared = 0, wrong = 0;
    for (size_t i = 0; i < order.size(); ++i) {
        if (order[i] == RT_NONE || hits[i].prim < 0) continue;
        const Vec direction = to_vec(primary.rays[i].direction), origin = to_vec(primary.rays[i].origin);
        const double t = hits[i].t;
        const Vec n = normals.at(hits[i].prim,
                                 {origin[0] + t * direction[0], origin[1] + t * direction[1], origin[2] + t * direction[2]});
        ++compared;
        if (std::fabs(std::fabs(dot(n, to_vec(&truth.pixels[3 * order[i]]))) - 1) > 1e-3) ++wrong;
    }
    EXPECT_GT(compared, 5000u);
    EXPECT_LE(wrong, compared / 1000);  // silhouettes
}

// The thesis's method for analytic spheres finds the same hits as trees.
TEST(NaiveMode, GivesTheSameHits) {
    const ScenePtr scene = load_scene(source_file("scenes/spheres21.scene"));
    const RaySet primary = camera_rays(make_view(*scene, 1).camera, 96, 96);
    Settings tree, lone;
    tree.accel = lone.accel = "spheres";
    choose_accel(Workbench::get().plugins(), "spheres,lone_spheres=true", lone);
    const auto expected = Workbench::get().rays(scene, tree, primary.rays, false);
    const auto hits = Workbench::get().rays(scene, lone, primary.rays, false);
    size_t spheres = 0;
    for (size_t i = 0; i < hits.size(); ++i) {
        if (!is_active(primary.rays[i])) continue;
        EXPECT_EQ(hits[i].prim, expected[i].prim);
        EXPECT_EQ(hits[i].t, expected[i].t);
        spheres += hits[i].prim >= 0 && hits[i].prim < 21;
    }
    EXPECT_GT(spheres, 500u);
}

TEST(Analysis, TwoPacketsMatchFiguresComputedByHand) {
    // Four lanes. First packet: all rays active, 10 nodes, 5 tests, 30 of the 40 lanes intersect the node. Second packet: one
    // ray active, 4 nodes, 2 tests, 4 lanes intersect.
    std::vector<rt_ray> rays(8);
    for (size_t i = 0; i < 8; ++i) rays[i].t_max = i < 5 ? 1 : -1;
    std::vector<rt_hit> hits(8);
    for (size_t i = 0; i < 8; ++i) {
        hits[i].steps = i < 4 ? 10 : 4;
        hits[i].leaf_tests = i < 4 ? 5 : 2;
        hits[i].lane_steps = i < 4 ? 30 : 4;
    }
    std::vector<RayWork> work(8);
    for (size_t i = 0; i < 8; ++i) work[i].boxes = i < 4 ? 20 : 6, work[i].own_boxes = i < 4 ? 0 : 4;
    const Analysis a = analyze(rays, hits, work, 4, 64);
    EXPECT_DOUBLE_EQ(a.boxes_per_ray, (4 * 20 + 10) / 5.0);
    EXPECT_EQ(a.reported, "boxes");
    EXPECT_TRUE(a.present);
    EXPECT_DOUBLE_EQ(a.nodes_per_ray, (4 * 10 + 4) / 5.0);
    EXPECT_DOUBLE_EQ(a.own_nodes_per_ray, 34 / 5.0);
    EXPECT_DOUBLE_EQ(a.leaf_tests_per_ray, (4 * 5 + 2) / 5.0);
    EXPECT_DOUBLE_EQ(a.lanes_alive, 34 / 56.0);
    EXPECT_DOUBLE_EQ(a.bytes_per_ray, (14 * 64 + 7 * 48) / 5.0);
    EXPECT_DOUBLE_EQ(a.bytes_shared, 1 - 14 / 34.0);
    EXPECT_DOUBLE_EQ(a.warp_alive, 0);
}

TEST(Analysis, OneLaneHasWarpFiguresAndNoSharedBytes) {
    std::vector<rt_ray> rays(64);
    std::vector<rt_hit> hits(64);
    for (size_t i = 0; i < 64; ++i) {
        rays[i].t_max = 1;
        hits[i].steps = hits[i].lane_steps = i < 32 ? 10 : (i == 32 ? 20 : 5);
    }
    const Analysis a = analyze(rays, hits, std::vector<RayWork>(64), 1, 64);
    EXPECT_EQ(a.reported, "");
    EXPECT_DOUBLE_EQ(a.warp_alive, (320.0 + 20 + 31 * 5) / (32 * 10 + 32 * 20));
    EXPECT_DOUBLE_EQ(a.lanes_alive, 1);
    EXPECT_DOUBLE_EQ(a.bytes_shared, 0);
}

// The baselines' hits are ours in every mode; otherwise comparing times would mean nothing.
TEST(Baselines, GiveTheSameHitsAsOurs) {
    std::string why;
    const std::vector<BaselineKind> kinds = baseline_kinds(&why);
    if (kinds.empty()) GTEST_SKIP() << "SKIPPED: " << why;
    const ScenePtr scene = shared_scene(scene_of(torus(2, 0.7, 48, 24)));
    ASSERT_EQ(baselines_cannot(*scene), "");
    const View view = view_from({0.5f, 4, 5}, {0, 0, 0}, 45);
    const RaySet primary = camera_rays(view.camera, 96, 96);
    const auto sets = secondary_rays(
        *scene, view.lights.empty() ? whitted_light(RT_LIGHT_POINT, {3, 5, 2}, {1, 1, 1}) : view.lights[0], primary, 96, 96,
        [&](const auto& rays) { return Workbench::get().rays(scene, Settings(), rays, false); });
    std::vector<const RaySet*> all = {&primary};
    for (const RaySet& set : sets) all.push_back(&set);
    const BaselineMesh mesh = make_baseline_mesh(*scene);
    EXPECT_EQ(mesh.triangle_count(), scene->triangle_count());
    for (const BaselineKind& kind : kinds) {
        const auto baseline = kind.build(mesh, kind.quality, 2);
        EXPECT_GT(baseline->bytes(), 0u);
        for (const RaySet* set : all) {
            const auto ours = Workbench::get().rays(scene, Settings(), set->rays, set->any_hit);
            baseline->take_rays(*set);
            for (const std::string& mode : baseline->modes()) {
                BaselineArray<BaselineHit> theirs;
                EXPECT_GE(baseline->trace_ms(mode, theirs), 0);
                ASSERT_GE(theirs.size(), set->rays.size());
                size_t differ = 0, hit = 0;
                for (size_t i = 0; i < set->rays.size(); ++i) {
                    if (!is_active(set->rays[i])) continue;
                    hit += std::isfinite(ours[i].t);
                    const bool same = std::isfinite(ours[i].t) == std::isfinite(theirs[i].t) &&
                                      (!std::isfinite(ours[i].t) || std::fabs(ours[i].t - theirs[i].t) <= 1e-4 * ours[i].t);
                    differ += !same;
                }
                EXPECT_GT(hit, 100u) << set->kind;
                EXPECT_LE(differ, 3u) << kind.name << " " << kind.quality << " " << mode << ", " << set->kind;
            }
        }
    }
}

}  // namespace
