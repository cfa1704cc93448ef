// placement_test.cpp -- compares rotated, scaled and mirrored meshes with the reference, placed once (flattened) and twice
// (instances). It tests normals, and which side is the inside of glass.
#include <gtest/gtest.h>

#include "reference/difference.hpp"
#include "reference/whitted.hpp"
#include "support/generated.hpp"
#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

struct Placement {
    const char* name;
    Affine world;
};
// Rows of a rotation about a slanted axis; the columns are scaled by sx, sy, sz.
Affine placed(double sx, double sy, double sz) {
    const double turn[9] = {0.7071068, -0.5, 0.5, 0.5, 0.8535534, 0.1464466, -0.5, 0.1464466, 0.8535534};
    Affine m{};
    for (int row = 0; row < 3; ++row) {
        m[4 * row + 0] = static_cast<float>(turn[3 * row + 0] * sx);
        m[4 * row + 1] = static_cast<float>(turn[3 * row + 1] * sy);
        m[4 * row + 2] = static_cast<float>(turn[3 * row + 2] * sz);
    }
    return m;
}

class Placements : public testing::TestWithParam<const char*> {};

TEST_P(Placements, EqualTheReferencePicture) {
    const ScenePtr model = load_scene(source_file(std::string("scenes/thesis/models/") + GetParam()));
    const Placement placements[] = {{"turned", placed(1, 1, 1)},
                                    {"stretched", placed(.6, 1.3, .8)},
                                    {"mirrored", placed(-1, 1, 1)},
                                    {"tiny and mirrored thrice", placed(-.01, -.012, -.01)}};
    for (const Placement& placement : placements)
        for (const int copies : {1, 2}) {
            Scene scene = *model;
            rt_material crystal = glass(1.5f);
            crystal.refract = .7f;  // some light is scattered, so that errors of normals are visible
            crystal.color[0] = crystal.color[1] = crystal.color[2] = .8f;
            scene.instances[0].material = add_material(scene, crystal);
            scene.instances[0].world_from_object = placement.world;
            if (copies == 2) {  // out of sight, behind the camera
                scene.instances.push_back(scene.instances[0]);
                scene.instances[1].world_from_object[11] = 50;
            }
            const ScenePtr shared = shared_scene(scene);
            const float size = std::string(placement.name).find("tiny") == 0 ? .01f : 1;
            View view = view_from({.3f * size, .4f * size, 4 * size}, {0, 0, 0}, 42);
            view.background = {.1f, .2f, .4f};
            view.ambient = {.1f, .1f, .1f};
            rt_light light{};
            light.position[0] = 2 * size;
            light.position[1] = light.position[2] = 4 * size;
            light.color[0] = light.color[1] = light.color[2] = .9f;
            view.lights = {light};
            Settings settings;
            settings.width = 160;
            settings.height = 120;
            settings.depth = 4;
            const auto d = reference::compare(Workbench::get().display(shared, settings, view),
                                              reference::to_display(reference::render(*shared, view, settings)));
            EXPECT_LE(d.share(), .002) << placement.name << ", " << copies << " times: " << d.beyond << " pixels, worst "
                                       << d.worst;
        }
}

INSTANTIATE_TEST_SUITE_P(All, Placements, testing::Values("ball.obj", "icosahedron.obj"),
                         [](const auto& info) { return std::string(info.param).substr(0, std::string(info.param).find('.')); });

}  // namespace
