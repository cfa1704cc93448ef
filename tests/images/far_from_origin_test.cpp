// far_from_origin_test.cpp -- rays that start at surfaces where floats are coarse neither hit the same surface again nor miss a
// near one. Scenes are moved by powers of two, so that their coordinates stay exact.
#include <gtest/gtest.h>

#include <cmath>

#include "images/optics.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

rt_light light_of(rt_u32 kind, const Point& position, float intensity) {
    return whitted_light(kind, position, {intensity, intensity, intensity});
}

// The same axis-aligned rectangle, which faces +z, as two triangles, as a polygon or as the mesh of an instance.
enum class Kind { triangles, polygon, instance };
constexpr Kind kKinds[] = {Kind::triangles, Kind::polygon, Kind::instance};
const char* name_of(Kind kind) {
    return kind == Kind::triangles ? "triangles" : kind == Kind::polygon ? "polygon" : "instance";
}

void add_instance(Scene& scene, rt_u32 mesh, const Point& at, float scale = 1) {
    place(scene, mesh, {scale, 0, 0, at[0], 0, scale, 0, at[1], 0, 0, scale, at[2]});
}

void add_rectangle(Scene& scene, Kind kind, const Point& center, float half, rt_u32 material) {
    const float x = center[0], y = center[1], z = center[2];
    if (kind == Kind::polygon) {
        Polygon polygon{};
        polygon.first_corner = static_cast<rt_u32>(scene.polygon_corners.size() / 3);
        polygon.corner_count = 4;
        polygon.material = material;
        for (const Point& p :
             {Point{x - half, y - half, z}, {x + half, y - half, z}, {x + half, y + half, z}, {x - half, y + half, z}})
            scene.polygon_corners.insert(scene.polygon_corners.end(), p.begin(), p.end());
        scene.polygons.push_back(polygon);
        return;
    }
    const bool moved = kind == Kind::instance;
    const Point at = moved ? Point{0, 0, 0} : center;
    TriangleMesh mesh;
    const auto corner = [&](float sx, float sy) { return Point{at[0] + sx * half, at[1] + sy * half, at[2]}; };
    mesh.add_quad(corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1));
    const rt_u32 number = add_mesh(scene, mesh, material);
    add_instance(scene, number, moved ? center : Point{0, 0, 0});
    if (moved) add_instance(scene, number, {x, y, z - 100});  // a mesh that is placed once would be flattened
}

TEST(FarFromOrigin, ALampFiveMillimetresAboveASurfaceLightsIt) {
    for (const Kind kind : kKinds)
        for (const Point& at : {Point{1000, 0, 0}, Point{1000, -1000, 1000}}) {
            Scene scene = scene_of(TriangleMesh());
            add_rectangle(scene, kind, at, 1, add_material(scene, diffuse(1, 1, 1)));
            View view = dark_view({at[0], at[1], at[2] + 1}, at, 2);
            view.camera.up = {0, 1, 0};
            view.lights = {light_of(RT_LIGHT_POINT, {at[0], at[1], at[2] + 0.005f}, 1)};
            const Picture picture = trace(scene, view, 64, 48, 1);
            size_t lit = 0;
            for (int y = 0; y < 48; ++y)
                for (int x = 0; x < 64; ++x) lit += picture.at(x, y)[1] > 0.1f;
            EXPECT_EQ(lit, 64u * 48u) << name_of(kind) << " at " << at[2];
        }
}

// The camera looks along a gap of 2 mm between a surface and an object that blocks the light.
TEST(FarFromOrigin, AGapOfTwoMillimetresCastsAShadow) {
    for (const Kind kind : kKinds)
        for (const Point& at : {Point{1000, 0, 0}, Point{1000, -1000, 1000}}) {
            Scene scene = scene_of(TriangleMesh());
            const rt_u32 white = add_material(scene, diffuse(1, 1, 1));
            add_rectangle(scene, kind, at, 1, white);
            add_rectangle(scene, kind, {at[0], at[1], at[2] + 0.002f}, 1, white);
            View view = dark_view({at[0], at[1] - 0.1f, at[2] + 0.001f}, {at[0], at[1], at[2] + 0.001f}, 20);
            view.camera.up = {0, 0, 1};
            view.lights = {light_of(RT_LIGHT_DIRECTIONAL, {0, 0, 1}, 1)};
            const Picture picture = trace(scene, view, 64, 48, 1);
            EXPECT_GT(picture.stats.shadow, 64u * 20u) << "the gap is not in the picture";
            size_t lit = 0;
            for (int y = 0; y < 48; ++y)
                for (int x = 0; x < 64; ++x) lit += picture.at(x, y)[1] > 0;
            EXPECT_EQ(lit, 0u) << name_of(kind) << " at " << at[2];
        }
}

// A room of 2 m: floor and back wall of triangles and a polygon, a mirror, a glass ball and a mesh that is placed twice.
Scene room(const Point& by) {
    const auto at = [&](float x, float y, float z) { return Point{by[0] + x, by[1] + y, by[2] + z}; };
    Scene scene = scene_of(TriangleMesh());
    const rt_u32 white = add_material(scene, diffuse(.8f, .8f, .8f)), mirrors = add_material(scene, mirror(.9f)),
                 crystal = add_material(scene, glass(1.5f));
    add_rectangle(scene, Kind::triangles, at(0, 0, 0), 1, white);
    TriangleMesh wall;
    wall.add_quad(at(-1, 1, 0), at(1, 1, 0), at(1, 1, 1), at(-1, 1, 1));
    add_instance(scene, add_mesh(scene, wall, mirrors), {0, 0, 0});
    const rt_u32 cube = add_mesh(scene, box(0.125), white);
    add_instance(scene, cube, at(.5f, .25f, .125f));
    add_instance(scene, cube, at(-.5f, .5f, .125f));
    Sphere ball;
    ball.center = at(0, 0, .375f);
    ball.radius = .25f;
    ball.material = crystal;
    scene.spheres.push_back(ball);
    ball.center = at(-.5f, -.25f, .25f);
    ball.radius = .125f;
    ball.material = white;
    scene.spheres.push_back(ball);
    return scene;
}

Picture room_picture(const Point& by, int depth) {
    const auto at = [&](float x, float y, float z) { return Point{by[0] + x, by[1] + y, by[2] + z}; };
    View view = view_from(at(.25f, -2, 1), at(0, 0, .25f), 40);
    view.camera.up = {0, 0, 1};
    view.background = {.2f, .3f, .4f};
    view.ambient = {.1f, .1f, .1f};
    view.lights = {light_of(RT_LIGHT_POINT, at(-1, -1, 2), .6f), light_of(RT_LIGHT_DIRECTIONAL, {.6f, 0, .8f}, .3f)};
    return trace(room(by), view, 160, 120, depth);
}

TEST(FarFromOrigin, ASmallSceneLooksAsItDoesAtTheOrigin) {
    for (const int depth : {1, 16}) {
        const Picture home = room_picture({0, 0, 0}, depth);
        struct {
            float far;
            double tolerance, share;  // at 131072 floats are 16 mm apart, which is visible in a glass ball 50 cm wide
        } const cases[] = {{1024, .004, depth == 1 ? .001 : .006}, {131072, .02, depth == 1 ? .08 : .14}};
        for (const auto& c : cases)
            for (const Point& by : {Point{c.far, 0, 0}, Point{0, 0, c.far}, Point{c.far, -c.far, c.far}}) {
                const Picture away = room_picture(by, depth);
                size_t differ = 0;
                for (int y = 0; y < home.height; ++y)
                    for (int x = 0; x < home.width; ++x) differ += std::fabs(home.at(x, y)[1] - away.at(x, y)[1]) > c.tolerance;
                const double share = double(differ) / (home.width * home.height);
                EXPECT_LE(share, c.share) << differ << " pixels, depth " << depth << ", moved by " << by[0] << " " << by[1]
                                          << " " << by[2];
            }
    }
}

// No light passes through a closed mesh, and no ray leaves it: rays that bounce between the mirrors inside never see the
// background.
TEST(FarFromOrigin, ClosedMirrorsKeepTheirRays) {
    for (const double scale : {1e-3, 1.0, 100.0})
        for (const float away : {0.f, 1000.f, 1e5f, 1e6f}) {
            if (scale < 1 && away > 0) continue;  // smaller than the distance between floats
            if (scale < 100 && away > 1e5f) continue;
            for (const unsigned copies : {1u, 2u}) {
                Scene scene = scene_of(box(scale));
                scene.materials[0].values = mirror(1);
                for (int k = 0; k < 3; ++k) scene.instances[0].world_from_object[4 * k + 3] = away;
                if (copies == 2) {
                    scene.instances.push_back(scene.instances[0]);
                    scene.instances[1].world_from_object[3] += static_cast<float>(10 * scale);
                }
                const auto s = static_cast<float>(scale);
                View view = dark_view({away + .25f * s, away - .125f * s, away + .5f * s},
                                      {away - .5f * s, away + .3f * s, away - s}, 70);
                view.background = {1, 1, 1};
                const Picture picture = trace(scene, view, 96, 72, 16);
                size_t bright = 0;
                for (int y = 0; y < 72; ++y)
                    for (int x = 0; x < 96; ++x) bright += picture.at(x, y)[1] > 0;
                EXPECT_EQ(bright, 0u) << "scale " << scale << ", at " << away << ", placed " << copies << " times";
                EXPECT_EQ(picture.stats.secondary, 15u * 96u * 72u);
            }
        }
}

// Glass of index 1 is invisible. A ray hits the surface of a ball twice; a ray that hit the same surface again would need one
// more generation.
TEST(FarFromOrigin, RaysCrossEachSurfaceOfGlassOnce) {
    for (const double scale : {1e-3, 1.0})
        for (const float away : {0.f, 1000.f, 131072.f})
            for (const int kind : {0, 1, 2}) {  // a sphere, a mesh, a mesh that is placed twice
                if (scale < 1 && away > 0) continue;
                Scene scene = scene_of(kind == 0 ? TriangleMesh() : uv_sphere(scale, 24, 12));
                scene.materials[0].values = glass(1);
                const auto s = static_cast<float>(scale);
                if (kind == 0) {
                    Sphere ball;
                    ball.center = {away, away, away};
                    ball.radius = s;
                    scene.spheres.push_back(ball);
                } else {
                    for (int k = 0; k < 3; ++k) scene.instances[0].world_from_object[4 * k + 3] = away;
                    if (kind == 2) {
                        scene.instances.push_back(scene.instances[0]);
                        scene.instances[1].world_from_object[3] += 10 * s;
                    }
                }
                View view = dark_view({away + .5f * s, away + .25f * s, away + 4 * s}, {away, away, away}, 40);
                view.background = {1, 1, 1};
                const Picture picture = trace(scene, view, 96, 72, 3);
                size_t dark = 0;
                for (int y = 0; y < 72; ++y)
                    for (int x = 0; x < 96; ++x) dark += picture.at(x, y)[1] < .99f;
                EXPECT_LE(dark, 96u * 72u / 500) << "kind " << kind << ", scale " << scale << ", at " << away;
            }
}

// No surface shades itself, for every kind of primitive, place and angle.
TEST(FarFromOrigin, NoSurfaceShadesItself) {
    for (const float away : {0.f, 1000.f, 131072.f})
        for (const int kind : {0, 1, 2}) {
            Scene scene = scene_of(kind == 0 ? TriangleMesh() : box(1));
            scene.materials[0].values = diffuse(1, 1, 1);
            const Affine turn = {.7071068f, -.5f, .5f, away, .5f, .8535534f, .1464466f, away, -.5f, .1464466f, .8535534f, away};
            if (kind == 0) {
                Sphere ball;
                ball.center = {away, away, away};
                ball.radius = 1;
                scene.spheres.push_back(ball);
            } else {
                scene.instances[0].world_from_object = turn;
                if (kind == 2) {
                    scene.instances.push_back(scene.instances[0]);
                    scene.instances[1].world_from_object[3] += 10;
                }
            }
            View view = dark_view({away + .5f, away + .75f, away + 4}, {away, away, away}, 40);
            view.lights = {light_of(RT_LIGHT_DIRECTIONAL, {.25916053f, .43193421f, .86386843f}, 1)};
            const Picture with = trace(scene, view, 160, 120, 1),
                          without = trace(scene, view, 160, 120, 1, {{"shadows", "false"}});
            size_t differ = 0, lit = 0;
            for (size_t i = 0; i < with.image.pixels.size(); ++i) {
                lit += without.image.pixels[i] > 0;
                differ += without.image.pixels[i] > .03f && with.image.pixels[i] != without.image.pixels[i];
            }
            EXPECT_GT(lit, 5000u);
            EXPECT_EQ(differ, 0u) << "of " << lit << ", kind " << kind << " at " << away;
        }
}

}  // namespace
