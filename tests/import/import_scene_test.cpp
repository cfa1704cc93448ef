// Bounds and areas of a scene, transforms, and validate(): every kind of damage is found and named.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "scene/camera.hpp"
#include "scene/scene.hpp"

namespace clarity {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// A scene with one of everything. Vertex 3 belongs to no triangle.
Scene sample() {
    Scene s;
    s.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 500, 500, 500};
    s.normals.assign(12, 0.f);
    s.uvs.assign(8, 0.f);
    s.colors.assign(16, 1.f);
    s.triangles = {0, 1, 2};
    s.triangle_materials = {0};
    s.meshes = {{"m", 0, 4, 0, 1, 1}};
    s.instances = {{"a", 0, RT_NONE, kIdentity}, {"b", 0, 0, {2, 0, 0, 10, 0, 2, 0, 0, 0, 0, 2, 0}}};
    s.spheres = {{{0, 0, 5}, 1, 0}};
    s.planes = {{{0, 1, 0}, -1, 0}};
    s.polygons = {{0, 4, 0}};
    s.polygon_corners = {-3, 0, 0, -1, 0, 0, -1, 2, 0, -3, 2, 0};
    s.materials = {{"default", default_material()}};
    s.textures = {{0, 2, 1, 0, 0, 0, 0}};
    s.texels = {1, 2};
    s.uvs2.assign(8, 0.f);
    s.tangents.assign(3, 0);
    s.maps = {{{1, 0, 0, 0, 1, 0}, 0, 1, 1, 0}};
    s.materials[0].maps[RT_MAP_EMISSION] = 0;
    s.lights.resize(1);
    s.cameras = {{"c", {0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.8f}};
    return s;
}

TEST(Scene, measures_count_every_instance) {
    const Scene s = sample();
    ASSERT_EQ(validate(s), "");
    EXPECT_EQ(s.placed_triangle_count(), 2u);
    EXPECT_NEAR(s.surface_area(), 0.5 + 2 + 4 + 4 * 3.14159265358979, 1e-6);
    const Bounds box = s.bounds();
    EXPECT_EQ(box.min, (std::array<float, 3>{-3, -1, 0})) << "stray vertices do not count";
    EXPECT_EQ(box.max, (std::array<float, 3>{12, 2, 6}));
    EXPECT_NEAR(box.diagonal(), std::sqrt(225 + 9 + 36), 1e-4);
}

TEST(Scene, area_follows_uneven_scales_and_mirrors) {
    Scene s = sample();
    s.spheres.clear();
    s.polygons.clear();
    s.instances = {{"", 0, RT_NONE, {-3, 0, 0, 0, 0, 2, 0, 0, 0, 0, 7, 0}}};
    EXPECT_NEAR(s.surface_area(), 3, 1e-6);
    s.instances = {{"", 0, RT_NONE, {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}}};
    EXPECT_NEAR(s.surface_area(), 0.5, 1e-6);
}

TEST(Scene, validate_names_every_damage) {
    const std::pair<const char*, std::function<void(Scene&)>> damages[] = {
        {"positions", [](Scene& s) { s.positions.own().pop_back(); }},
        {"position 1: not a finite", [](Scene& s) { s.positions.own()[4] = kNan; }},
        {"position 3: not a finite", [](Scene& s) { s.positions.own()[11] = -std::numeric_limits<float>::infinity(); }},
        {"normals", [](Scene& s) { s.normals.resize(9); }},
        {"normal 2", [](Scene& s) { s.normals.own()[6] = kNan; }},
        {"uvs", [](Scene& s) { s.uvs.resize(3); }},
        {"uv 3", [](Scene& s) { s.uvs.own()[7] = kNan; }},
        {"colors", [](Scene& s) { s.colors.resize(12); }},
        {"color 3", [](Scene& s) { s.colors.own()[15] = kNan; }},
        {"triangles", [](Scene& s) { s.triangles.push_back(0); }},
        {"triangle materials", [](Scene& s) { s.triangle_materials.clear(); }},
        {"material 1 of 1", [](Scene& s) { s.triangle_materials.own()[0] = 1; }},
        {"triangle 0: vertex 4", [](Scene& s) { s.triangles.own()[1] = 4; }},
        {"triangle 0: vertex 4294967295", [](Scene& s) { s.triangles.own()[2] = 0xFFFFFFFFu; }},
        {"mesh 0", [](Scene& s) { s.meshes[0].vertex_count = 5; }},
        {"mesh 0", [](Scene& s) { s.meshes[0].first_vertex = 0xFFFFFFFFu; }},
        {"mesh 0", [](Scene& s) { s.meshes[0].triangle_count = 0xFFFFFFFFu; }},
        {"not of its mesh", [](Scene& s) { s.meshes[0].vertex_count = 2; }},
        {"not of its mesh",
         [](Scene& s) {
             s.meshes[0].first_vertex = 1;
             s.meshes[0].vertex_count = 3;
         }},
        {"instance 1: mesh 1 of 1", [](Scene& s) { s.instances[1].mesh = 1; }},
        {"instance 1: material 1 of 1", [](Scene& s) { s.instances[1].material = 1; }},
        {"instance 0: its transform", [](Scene& s) { s.instances[0].world_from_object[7] = kNan; }},
        {"sphere 0: its centre", [](Scene& s) { s.spheres[0].center[1] = kNan; }},
        {"sphere 0: its radius", [](Scene& s) { s.spheres[0].radius = -1; }},
        {"sphere 0: material", [](Scene& s) { s.spheres[0].material = 9; }},
        {"plane 0: its normal", [](Scene& s) { s.planes[0].normal = {0, 2, 0}; }},
        {"plane 0: its normal", [](Scene& s) { s.planes[0].normal = {0, kNan, 0}; }},
        {"plane 0: its offset", [](Scene& s) { s.planes[0].offset = kNan; }},
        {"plane 0: material", [](Scene& s) { s.planes[0].material = 9; }},
        {"polygon 0: fewer", [](Scene& s) { s.polygons[0].corner_count = 2; }},
        {"polygon 0: corners", [](Scene& s) { s.polygons[0].first_corner = 1; }},
        {"polygon 0: corners", [](Scene& s) { s.polygons[0].first_corner = 0xFFFFFFFFu; }},
        {"polygon 0: material", [](Scene& s) { s.polygons[0].material = 9; }},
        {"polygon corner 1", [](Scene& s) { s.polygon_corners[5] = kNan; }},
        {"default material",
         [](Scene& s) {
             s.materials.clear();
             s.triangle_materials.clear();
             s.tangents.clear();
             s.triangles.clear();
             s.meshes.clear();
             s.instances.clear();
             s.spheres.clear();
             s.planes.clear();
             s.polygons.clear();
         }},
        {"material 0: not a finite", [](Scene& s) { s.materials[0].values.emission[2] = kNan; }},
        {"material 0: `reflect` is 1.5, expected from 0 to 1", [](Scene& s) { s.materials[0].values.reflect = 1.5f; }},
        {"material 0: `ior` is 0, expected from 0.001 to 100", [](Scene& s) { s.materials[0].values.ior = 0; }},
        {"material 0: texture 1 of 1", [](Scene& s) { s.materials[0].values.texture = 1; }},
        {"texture 0: texels", [](Scene& s) { s.textures[0].width = 3; }},
        {"texture 0: texels", [](Scene& s) { s.textures[0].first = 0xFFFFFFFFu; }},
        {"texture 0: texels", [](Scene& s) { s.textures[0].width = s.textures[0].height = 0xFFFFFFFFu; }},
        {"texture 0: it is empty", [](Scene& s) { s.textures[0].height = 0; }},
        {"texture 0: it is empty", [](Scene& s) { s.textures[0].levels = 2; }},
        {"texture 0: texels", [](Scene& s) { s.textures[0].levels = 1; }},
        {"texture 0: unknown flags", [](Scene& s) { s.textures[0].flags = 8; }},
        {"material 0: map 1 of 1", [](Scene& s) { s.materials[0].maps[RT_MAP_NORMAL] = 1; }},
        {"map 0: texture 1 of 1", [](Scene& s) { s.maps[0].texture = 1; }},
        {"map 0: set 2", [](Scene& s) { s.maps[0].set = 2; }},
        {"map 0: not a finite", [](Scene& s) { s.maps[0].matrix[4] = kNan; }},
        {"map 0: not a finite", [](Scene& s) { s.maps[0].scale = kNan; }},
        {"uvs2", [](Scene& s) { s.uvs2.resize(3); }},
        {"uv2 3", [](Scene& s) { s.uvs2.own()[7] = kNan; }},
        {"tangents", [](Scene& s) { s.tangents.push_back(0); }},
        {"light 0: unknown", [](Scene& s) { s.lights[0].values.kind = 7; }},
        {"light 0: not a finite", [](Scene& s) { s.lights[0].values.color[0] = kNan; }},
        {"light 0: `color` is -1 0 0", [](Scene& s) { s.lights[0].values.color[0] = -1; }},
        {"camera 0: aperture or focus", [](Scene& s) { s.cameras[0].aperture = -1; }},
        {"material 0: `model` is 22", [](Scene& s) { s.materials[0].values.model = RT_MODEL_KINDS + 16; }},
        {"camera 0: not a finite", [](Scene& s) { s.cameras[0].up[0] = kNan; }},
        {"camera 0: field of view", [](Scene& s) { s.cameras[0].fov_y_rad = 4; }},
        {"camera 0: field of view", [](Scene& s) { s.cameras[0].fov_y_rad = kNan; }},
        {"camera 0: it looks", [](Scene& s) { s.cameras[0].target = s.cameras[0].eye; }},
        {"background", [](Scene& s) { s.background[0] = kNan; }},
        {"up axis", [](Scene& s) { s.up_axis = 3; }},
        {"unit scale", [](Scene& s) { s.unit_scale = -1; }},
    };
    for (const auto& [expected, damage] : damages) {
        Scene s = sample();
        damage(s);
        EXPECT_NE(validate(s).text().find(expected), std::string::npos)
            << "expected \"" << expected << "\", got \"" << validate(s) << "\"";
    }
    EXPECT_NE(validate(Scene{}), "") << "not even a default material";
}

TEST(Transform, products_and_inverses) {
    const Affine a = {0, -2, 0, 1, 2, 0, 0, 2, 0, 0, 3, 3}, b = {1, 0, 0.5f, 4, 0, 1, 0, 5, 0, 0, 1, 6};
    const float p[3] = {1, 2, 3};
    const std::array<float, 3> once = transform_point(b, p), twice = transform_point(a, once.data());
    EXPECT_EQ(transform_point(multiply(a, b), p), twice);
    Affine inverse;
    ASSERT_TRUE(invert(a, inverse));
    const std::array<float, 3> moved = transform_point(a, p), back = transform_point(inverse, moved.data());
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(back[i], p[i], 1e-5f);
    EXPECT_TRUE(invert({1e-9f, 0, 0, 0, 0, 1e-9f, 0, 0, 0, 0, 1e-9f, 0}, inverse)) << "small is not singular";
    EXPECT_FALSE(invert({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0}, inverse));
    EXPECT_FALSE(invert({1, 2, 3, 0, 2, 4, 6, 0, 0, 0, 1, 0}, inverse));
    EXPECT_FALSE(invert({kNan, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, inverse));
}

// Projects a point with the camera model of docs/scene_format.md; both coordinates are -1..1 within the picture.
std::array<double, 3> on_screen(const Camera& c, float aspect, const std::array<float, 3>& p) {
    double w[3], u[3], v[3], d[3];
    const auto normalize = [](double* x) {
        const double l = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        for (int i = 0; i < 3; ++i) x[i] /= l;
    };
    const auto cross = [](const double* a, const double* b, double* r) {
        for (int i = 0; i < 3; ++i) r[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
    };
    const double up[3] = {c.up[0], c.up[1], c.up[2]};
    for (int i = 0; i < 3; ++i) w[i] = double(c.target[i]) - c.eye[i];
    normalize(w);
    cross(w, up, u);
    normalize(u);
    cross(u, w, v);
    double x = 0, y = 0, z = 0;
    for (int i = 0; i < 3; ++i) {
        d[i] = double(p[i]) - c.eye[i];
        x += d[i] * u[i];
        y += d[i] * v[i];
        z += d[i] * w[i];
    }
    const double tan_y = std::tan(c.fov_y_rad / 2);
    return {x / z / tan_y / aspect, y / z / tan_y, z};
}

TEST(Scene, the_framing_camera_sees_all_and_not_from_far_away) {
    for (const rt_u32 up_axis : {0u, 1u, 2u}) {
        for (const float aspect : {0.4f, 1.f, 1.7f}) {
            Scene s = sample();
            s.up_axis = up_axis;
            const Camera camera = framing_camera(s, aspect);
            EXPECT_EQ(camera.up[up_axis], 1.f);
            const Bounds box = s.bounds();
            double widest = 0;
            for (int corner = 0; corner < 8; ++corner) {
                std::array<float, 3> p{};
                for (int i = 0; i < 3; ++i) p[i] = (corner >> i & 1) != 0 ? box.max[i] : box.min[i];
                const auto at = on_screen(camera, aspect, p);
                EXPECT_GT(at[2], 0);
                widest = std::max({widest, std::abs(at[0]), std::abs(at[1])});
            }
            EXPECT_LE(widest, 1.0);
            EXPECT_GE(widest, 0.85);
        }
    }
    for (const float aspect : {0.f, kNan}) {
        Scene empty;
        empty.materials = {{"default", default_material()}};
        empty.cameras = {framing_camera(empty, aspect)};
        EXPECT_EQ(validate(empty), "");
    }
}

}  // namespace
}  // namespace clarity
