// masks_test.cpp -- instances that some kinds of rays pass: as if they were not there for those, in all structures and tracers.
#include <gtest/gtest.h>

#include <random>

#include "scene/light_kinds.hpp"
#include "support/generated.hpp"
#include "support/planted_faults.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// Boxes beside each other, of one mesh and of meshes of their own, with masks; and a sphere, which has none.
Scene row_of_boxes() {
    Scene scene;
    for (int m = 0; m < 3; ++m) add_mesh(scene, box(0.4));
    const rt_u32 masks[] = {RT_SEEN_BY_CAMERA, RT_SEEN_BY_SHADOW | RT_SEEN_BY_MIRROR, 8, RT_SEEN_BY_ALL, 0};
    for (rt_u32 i = 0; i < 5; ++i) {
        Instance& instance = place(scene, i < 3 ? 0 : i - 2);
        instance.world_from_object[3] = float(i) - 2;
        instance.world_from_object[11] = 0.25f * float(i % 2);
        instance.mask = masks[i];
        instance.apart = true;
    }
    scene.spheres.push_back({{0, 1.2f, 0}, 0.5f, 0});
    return scene;
}

// The same where what rays of this mask pass is not there.
Scene without_passed(Scene scene, rt_u32 mask) {
    for (Instance& instance : scene.instances) {
        instance.visible = (instance.mask & mask) != 0;
        instance.mask = RT_SEEN_BY_ALL;
    }
    return scene;
}

std::vector<rt_ray> rays_through_it() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> at(-3, 3);
    std::normal_distribution<float> normal;
    std::vector<rt_ray> rays;
    for (int i = 0; i < 1500; ++i) {
        rt_ray ray{{at(random), at(random), at(random)}, 0, {}, INFINITY};
        for (int k = 0; k < 3; ++k) ray.direction[k] = 0.5f * (k == 0 ? at(random) : 0.3f * normal(random)) - ray.origin[k];
        rays.push_back(ray);
    }
    return rays;
}

// What a ray meets is the same by all structures and lanes, so `linear` says it for all.
TEST(Masks, RaysPassWhatTheyDoNotSee) {
    const std::vector<rt_ray> rays = rays_through_it();
    const ScenePtr masked = shared_scene(row_of_boxes());
    struct Asked {
        RayQuery query;
        std::vector<rt_hit> expected;
    };
    std::vector<Asked> asked;
    const Settings by_linear = make_settings({{"accel", "linear"}, {"lanes", "16"}});
    for (const rt_u32 mask : {1u, 2u, 4u, 8u, 9u, 255u, 0u})
        for (const bool any : {false, true}) {
            RayQuery query;
            query.any_hit = any;
            asked.push_back(
                {query, Workbench::get().rays(shared_scene(without_passed(row_of_boxes(), mask)), by_linear, rays, query)});
            asked.back().query.mask = mask;
        }
    for (const std::string& accel : Workbench::get().accels())
        for (const char* lanes : {"1", "16"}) {
            if (few_ways() && (accel == "linear") == (lanes == std::string("1"))) continue;
            for (const auto& [query, expected] : asked) {
                const auto hits =
                    Workbench::get().rays(masked, make_settings({{"accel", accel}, {"lanes", lanes}}), rays, query);
                for (size_t i = 0; i < rays.size(); ++i)
                    ASSERT_TRUE(hits[i].t == expected[i].t && hits[i].prim == expected[i].prim)
                        << accel << ", " << lanes << " lanes, mask " << query.mask << (query.any_hit ? ", any" : "") << ", ray "
                        << i;
            }
        }
}

// A box over a floor that mirrors, out of the camera's sight: its shadow and its mirror image are in the picture.
ScenePtr over_a_floor(rt_u32 mask, bool visible = true) {
    Scene scene = scene_of(box(0.5));
    scene.materials[0].values = diffuse(0.8f, 0.3f, 0.2f);
    scene.planes.push_back({{0, 1, 0}, -1, add_material(scene, mirror(0.4f))});
    scene.materials.back().values.color[0] = scene.materials.back().values.color[1] = 0.5f;
    scene.instances[0].world_from_object[7] = 0.3f;
    scene.instances[0].apart = true;
    scene.instances[0].mask = mask;
    scene.instances[0].visible = visible;
    return shared_scene(scene);
}

FloatImage picture(const ScenePtr& scene, const std::vector<std::pair<std::string, std::string>>& how, bool from_above) {
    std::vector<std::pair<std::string, std::string>> words = how;
    words.insert(words.end(), {{"accel", "bvh2"}, {"size", "40x24"}, {"depth", "3"}, {"spp", "1"}});
    View view = from_above ? view_from({0, 6, 5}, {0, -1, 0.5f}, 60) : view_from({0, 0.1f, 3}, {0, -1, 1.8f}, 40);
    view.lights.push_back(whitted_light(RT_LIGHT_DIRECTIONAL, {0, 0.6f, -0.8f}, {1, 1, 1}));
    view.background = {0.2f, 0.3f, 0.4f};
    view.ambient = {0.1f, 0.1f, 0.1f};
    return Workbench::get().values(scene, make_settings(words), view);
}

TEST(Masks, OfPicturesGoByTheKindOfRays) {
    const std::vector<std::vector<std::pair<std::string, std::string>>> ways = {
        {{"tracer", "iterative"}, {"lanes", "16"}, {"packet", "4x4"}},
        {{"tracer", "iterative"}, {"lanes", "1"}, {"packet", "1x1"}},
        {{"tracer", "iterative"}, {"lanes", "1"}, {"packet", "1x1"}, {"portable", "true"}},
        {{"tracer", "wavefront"}},
        {{"tracer", "path"}},
    };
    for (const auto& way : ways) {
        if (few_ways() && &way != &ways.front()) continue;
        const std::string what = way[0].second + ", " + (way.size() > 1 ? way[1].second : "its own") + " lanes";
        const auto of = [&](rt_u32 mask, bool visible = true) {
            return picture(over_a_floor(mask, visible), way, false).pixels;
        };
        const auto all = of(RT_SEEN_BY_ALL), none = of(RT_SEEN_BY_ALL, false), shadow = of(RT_SEEN_BY_ALL - RT_SEEN_BY_MIRROR),
                   mirrored = of(RT_SEEN_BY_ALL - RT_SEEN_BY_SHADOW);
        EXPECT_TRUE(of(RT_SEEN_BY_MIRROR | RT_SEEN_BY_SHADOW) == all) << what << ": the camera does not see it anyway";
        EXPECT_TRUE(of(RT_SEEN_BY_CAMERA) == none) << what;
        EXPECT_TRUE(of(RT_SEEN_BY_ALL - RT_SEEN_BY_MIRROR - RT_SEEN_BY_SHADOW) == none) << what;
        EXPECT_FALSE(all == none || shadow == all || shadow == none || mirrored == all || mirrored == none ||
                     shadow == mirrored)
            << what << ": the shadow and the mirror image are apart";
        // From above the box itself is in the picture, and without camera rays its shadow alone.
        const auto seen = [&](rt_u32 mask) {
            auto depth = way;
            depth.push_back({"aov", "t"});
            return picture(over_a_floor(mask), depth, true).pixels;
        };
        EXPECT_FALSE(seen(RT_SEEN_BY_ALL) == seen(RT_SEEN_BY_ALL - RT_SEEN_BY_CAMERA)) << what;
        const auto above = [&](rt_u32 mask) { return picture(over_a_floor(mask), way, true).pixels; };
        EXPECT_FALSE(above(RT_SEEN_BY_ALL) == above(RT_SEEN_BY_ALL - RT_SEEN_BY_CAMERA)) << what;
    }
}

const PlantedFault kMaskFaults[] = {
    {"instances have no mask", "primitives/leaf_scene.h", "~instance->hidden)", "0xffffffffu)", "Masks.RaysPass*"},
    {"queries have no mask", "tracers/rays/ray_blocks.h", "rt_vint((int)frame->ray_mask)", "rt_vint(255)", "Masks.RaysPass*"},
    {"shadow rays are the camera's", "shading/shading.h", "rt_vint(RT_SEEN_BY_SHADOW)", "rt_vint(RT_SEEN_BY_CAMERA)",
     "Masks.OfPictures*"},
    {"mirror rays are the camera's", "tracers/iterative/generations.h", "? RT_SEEN_BY_CAMERA : RT_SEEN_BY_MIRROR",
     "? RT_SEEN_BY_CAMERA : RT_SEEN_BY_CAMERA", "Masks.OfPictures*"},
    {"so are those of one pixel", "tracers/iterative/iterative_single.h", "? RT_SEEN_BY_CAMERA : RT_SEEN_BY_MIRROR",
     "? RT_SEEN_BY_CAMERA : RT_SEEN_BY_CAMERA", "Masks.OfPictures*"},
    {"so are those of wavefront", "tracers/wavefront/wavefront.cl", "RT_MASK(generation == rt_vint(0))",
     "RT_MASK(generation >= rt_vint(0))", "Masks.OfPictures*"},
    {"so are those of paths", "tracers/path/scatter.h", "RT_SEEN_BY(&ray, rt_select(RT_MASK(p->event == rt_vint(0))",
     "RT_SEEN_BY(&ray, rt_select(RT_MASK(p->event >= rt_vint(0))", "Masks.OfPictures*"},
    {"the camera sees what mirrors see", "tracers/aov/aov.cl", "rt_vint(RT_SEEN_BY_CAMERA)", "rt_vint(RT_SEEN_BY_ALL)",
     "Masks.OfPictures*"},
};

TEST(MasksTexts, HaveTheirTexts) {
    expect_plantable(kMaskFaults);
}

TEST(MasksFaults, AreFound) {
    expect_found(kMaskFaults);
}

}  // namespace
