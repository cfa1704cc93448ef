#include "reference/closed_form_parts.hpp"

#include <algorithm>
#include <cstdio>

#include "base/angle.hpp"

namespace clarity::reference::parts {

using test::add_material;

rt_material material(rt_u32 model, float color, float roughness, rt_u32 flags) {
    rt_material m = default_material();
    m.model = model;
    m.roughness = roughness;
    m.flags = flags;
    for (int c = 0; c < 3; ++c) {
        m.color[c] = color;
        m.specular[c] = 0;
    }
    return m;
}
rt_material lambert(float albedo, float emission) {
    rt_material m = material(RT_MODEL_LAMBERT, albedo);
    std::fill(m.emission, m.emission + 3, emission);
    return m;
}
rt_material dielectric(float ior, float roughness) {
    rt_material m = material(RT_MODEL_DIELECTRIC, 1, roughness);
    m.ior = ior;
    return m;
}

rt_light light(rt_u32 kind, const Vec& position, float color, rt_u32 flags) {
    rt_light l{};
    l.kind = kind;
    l.flags = flags;
    for (size_t k = 0; k < 3; ++k) {
        l.position[k] = float(position[k]);
        l.color[k] = color;
    }
    return l;
}
rt_light rect(double height, float a, float b, float radiance, bool down) {
    rt_light l = light(RT_LIGHT_RECT, {0, height, 0}, radiance);
    l.u[0] = a;
    l.v[2] = down ? b : -b;
    l.normal[1] = down ? -1.0f : 1.0f;
    l.area = 4 * a * b;
    return l;
}
rt_light disc(float height, float radius, float radiance) {
    rt_light l = light(RT_LIGHT_DISC, {0, height, 0}, radiance);
    l.radius = radius;
    l.normal[1] = -1;
    l.area = float(kPi) * radius * radius;
    return l;
}
rt_light sphere(const Vec& middle, float radius, float radiance) {
    rt_light l = light(RT_LIGHT_SPHERE, middle, radiance);
    l.radius = radius;
    l.area = float(4 * kPi) * radius * radius;
    return l;
}
rt_light sun(double angle_from_y_deg, double diameter_deg, float irradiance) {
    const double a = angle_from_y_deg * kRadPerDegree;
    rt_light l = light(RT_LIGHT_SUN, {std::sin(a), std::cos(a), 0}, irradiance);
    l.cos_outer = float(std::cos(0.5 * diameter_deg * kRadPerDegree));
    return l;
}

View looking_at(const Vec& point, const Vec& from, double distance, float background, double fov_deg) {
    View view = test::view_from(to_floats(point + distance * from), to_floats(point), fov_deg);
    view.camera.up = std::fabs(from[1]) > 0.9 ? std::array<float, 3>{1, 0, 0} : std::array<float, 3>{0, 1, 0};
    view.background = {background, background, background};
    view.ambient = {0, 0, 0};
    return view;
}
Vec slanted(double deg) {
    return {std::sin(deg * kRadPerDegree), std::cos(deg * kRadPerDegree), 0};
}

Scene empty() {
    return test::scene_of(TriangleMesh());
}
Scene ground(const rt_material& m) {
    Scene scene = empty();
    scene.planes.push_back({{0, 1, 0}, 0, add_material(scene, m)});
    return scene;
}
Scene ball(const rt_material& m) {
    Scene scene = empty();
    scene.spheres.push_back({{0, 0, 0}, 1, add_material(scene, m)});
    return scene;
}
void add_quad(TriangleMesh& mesh, const Vec& corner, const Vec& a, const Vec& b) {
    mesh.add_quad(corner, corner + a, corner + a + b, corner + b);
}
Scene of_mesh(const TriangleMesh& mesh, const rt_material& m) {
    Scene scene = test::scene_of(mesh);
    const rt_u32 number = add_material(scene, m);
    scene.triangle_materials.assign(mesh.triangles.size() / 3, number);
    return scene;
}
Scene room(const rt_material& m) {
    TriangleMesh mesh;
    add_quad(mesh, {-0.5, 0, -0.5}, {0, 0, 1}, {1, 0, 0});
    add_quad(mesh, {-0.5, 0, -0.5}, {0, 1, 0}, {0, 0, 1});
    add_quad(mesh, {0.5, 0, -0.5}, {0, 0, 1}, {0, 1, 0});
    add_quad(mesh, {-0.5, 0, -0.5}, {1, 0, 0}, {0, 1, 0});
    add_quad(mesh, {-0.5, 0, 0.5}, {0, 1, 0}, {1, 0, 0});
    return of_mesh(mesh, m);
}
View of_face(const Vec& middle, const Vec& normal) {
    constexpr double kDistance = 0.9;
    return looking_at(middle, normal, kDistance, 0, 2 * std::atan(0.5 / kDistance) / kRadPerDegree);
}
Scene slab(const rt_material& m) {
    TriangleMesh mesh;
    const double s = 100;
    add_quad(mesh, {-s, 1, -s}, {0, 0, 2 * s}, {2 * s, 0, 0});
    add_quad(mesh, {-s, 0, -s}, {2 * s, 0, 0}, {0, 0, 2 * s});
    add_quad(mesh, {-s, 0, -s}, {0, 0, 2 * s}, {0, 1, 0});
    add_quad(mesh, {s, 0, -s}, {0, 1, 0}, {0, 0, 2 * s});
    add_quad(mesh, {-s, 0, -s}, {0, 1, 0}, {2 * s, 0, 0});
    add_quad(mesh, {-s, 0, s}, {2 * s, 0, 0}, {0, 1, 0});
    return of_mesh(mesh, m);
}

std::string text(double number) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%g", number);
    return digits;
}

View whole_ball() {
    constexpr double kDistance = 20;
    return looking_at({0, 0, 0}, {0, 0, 1}, kDistance, 1, 2 * std::asin(1 / kDistance) / kRadPerDegree);
}
double with_corners(double albedo) {
    return 1 - kPi / 4 * (1 - albedo);
}

Scene under_gradient(Scene scene, float zenith, float horizon) {
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_GRADIENT;
    for (int k = 0; k < 3; ++k) sky.color[k] = zenith, sky.horizon[k] = horizon, sky.ground[k] = 0;
    return scene;
}

Scene under_lobe(Scene scene, double deg, double n, rt_u32 height) {
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_PICTURE;
    sky.width = 2 * height;
    sky.height = height;
    std::vector<float> texels;
    const double s = std::sin(deg * kRadPerDegree), c = std::cos(deg * kRadPerDegree);
    for (rt_u32 y = 0; y < height; ++y)
        for (rt_u32 x = 0; x < 2 * height; ++x) {
            const double theta = kPi * (y + 0.5) / height, phi = kPi * ((x + 0.5) / height - 1);
            const double cosine = std::cos(theta) * c + std::sin(theta) * std::sin(phi) * s;
            texels.insert(texels.end(), 3, float(std::pow(std::max(cosine, 0.0), n)));
        }
    scene.sky.texels = std::move(texels);
    return scene;
}

}  // namespace clarity::reference::parts
