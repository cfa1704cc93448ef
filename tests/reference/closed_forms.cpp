#include "reference/closed_forms.hpp"

#include <algorithm>
#include <functional>

#include "base/angle.hpp"
#include "support/generated.hpp"

namespace clarity::reference {
namespace {

using test::add_material;
using test::TriangleMesh;

constexpr double kNarrow_deg = 0.01;

rt_material material(rt_u32 model, float color, float roughness = 0, rt_u32 flags = 0) {
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
rt_material lambert(float albedo, float emission = 0) {
    rt_material m = material(RT_MODEL_LAMBERT, albedo);
    std::fill(m.emission, m.emission + 3, emission);
    return m;
}
rt_material dielectric(float ior, float roughness = 0) {
    rt_material m = material(RT_MODEL_DIELECTRIC, 1, roughness);
    m.ior = ior;
    return m;
}

rt_light light(rt_u32 kind, const Vec& position, float color, rt_u32 flags = 0) {
    rt_light l{};
    l.kind = kind;
    l.flags = flags;
    for (size_t k = 0; k < 3; ++k) {
        l.position[k] = float(position[k]);
        l.color[k] = color;
    }
    return l;
}
// A rectangle of half sides a and b across y = height that shines down, or up.
rt_light rect(double height, float a, float b, float radiance, bool down = true) {
    rt_light l = light(RT_LIGHT_RECT, {0, height, 0}, radiance);
    l.u[0] = a;
    l.v[2] = down ? b : -b;
    l.normal[1] = down ? -1.0f : 1.0f;
    l.area = 4 * a * b;
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

// Looks at a point from a distance, against `from`, a unit vector.
View looking_at(const Vec& point, const Vec& from, double distance, float background, double fov_deg = kNarrow_deg) {
    View view = test::view_from(to_floats(point + distance * from), to_floats(point), fov_deg);
    view.camera.up = std::fabs(from[1]) > 0.9 ? std::array<float, 3>{1, 0, 0} : std::array<float, 3>{0, 1, 0};
    view.background = {background, background, background};
    view.ambient = {0, 0, 0};
    return view;
}
// At an angle from the y axis.
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
    rt_u32 v[4];
    const Vec at[4] = {corner, corner + a, corner + a + b, corner + b};
    for (int k = 0; k < 4; ++k) v[k] = mesh.add_vertex(at[k][0], at[k][1], at[k][2]);
    mesh.add_triangle(v[0], v[1], v[2]);
    mesh.add_triangle(v[0], v[2], v[3]);
}
Scene of_mesh(const TriangleMesh& mesh, const rt_material& m) {
    Scene scene = test::scene_of(mesh);
    const rt_u32 number = add_material(scene, m);
    scene.triangle_materials.assign(mesh.triangles.size() / 3, number);
    return scene;
}
// The unit cube without its ceiling, which is a light.
Scene room(const rt_material& m) {
    TriangleMesh mesh;
    add_quad(mesh, {-0.5, 0, -0.5}, {0, 0, 1}, {1, 0, 0});
    add_quad(mesh, {-0.5, 0, -0.5}, {0, 1, 0}, {0, 0, 1});
    add_quad(mesh, {0.5, 0, -0.5}, {0, 0, 1}, {0, 1, 0});
    add_quad(mesh, {-0.5, 0, -0.5}, {1, 0, 0}, {0, 1, 0});
    add_quad(mesh, {-0.5, 0, 0.5}, {0, 1, 0}, {1, 0, 0});
    return of_mesh(mesh, m);
}
// A closed slab from y = 0 to 1 that is 200 wide.
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

class List {
 public:
    std::vector<ClosedForm> forms;
    void add(const std::string& name, const Scene& scene, View view, const std::vector<rt_light>& lights, unsigned depth,
             const Vec& expected, double rounding = 1e-5) {
        view.lights = lights;
        forms.push_back({name, scene, std::move(view), depth, expected, rounding});
    }
    void add(const std::string& name, const Scene& scene, View view, const std::vector<rt_light>& lights, unsigned depth,
             double expected, double rounding = 1e-5) {
        add(name, scene, std::move(view), lights, depth, Vec{expected, expected, expected}, rounding);
    }
};

void add_furnaces(List& list) {
    // Inside of a closed body that emits 1, n events leave (1 - r^(n+1)) / (1 - r).
    View inside = looking_at({0.3, 0, 0}, {1, 0, 0}, 0.2, 0, 40);
    for (const unsigned n : {1u, 2u, 4u, 8u})
        list.add("furnace of " + std::to_string(n) + " events", ball(lambert(0.5f, 1)), inside, {}, n, 2 - std::pow(0.5, n));
    const View outside = looking_at({0, 0, 0}, {0, 0, 1}, 5, 1, 14);
    list.add("Lambert ball under a uniform sky", ball(lambert(0.5f)), outside, {}, 4, 0.5);
    list.add("white rough metal ball under a uniform sky", ball(material(RT_MODEL_CONDUCTOR, 1, 0.6f)), outside, {}, 8, 1,
             0.001);
    list.add("smooth glass ball under a uniform sky", ball(dielectric(1.5f)), outside, {}, 64, 1);
    list.add("rough glass ball under a uniform sky", ball(dielectric(1.5f, 0.5f)), outside, {}, 100, 1, 0.0015);
    const Scene bare = ground(material(RT_MODEL_CONDUCTOR, 1, 1, RT_MATERIAL_SINGLE_SCATTER));
    // Albedos of a single scattering: height-correlated GGX by quadrature.
    list.add("rough metal that scatters once, cosine 0.2", bare,
             looking_at({0, 0, 0}, slanted(std::acos(0.2) / kRadPerDegree), 3, 1), {}, 1, 0.6416, 1e-4);
    list.add("rough metal that scatters once, cosine 1", bare, looking_at({0, 0, 0}, slanted(0), 3, 1), {}, 1, 0.3069, 1e-4);
    rt_material mixture = material(RT_MODEL_WHITTED, 0.5f);
    mixture.reflect = 0.3f;
    list.add("Whitted's mixture under a uniform sky", ground(mixture), looking_at({0, 0, 0}, slanted(40), 3, 1), {}, 3, 0.65);
}

void add_lights(List& list) {
    // A ball of albedo 0.5 under a spherical light of radiance 10 and radius 0.5, 3 above: r L R^2 cos / d^2; by quadrature
    // where the horizon cuts the light. Angles from the top.
    const struct {
        double deg, radiance;
    } under_sphere[] = {{0, 0.3125}, {30, 0.189725}, {45, 0.101462}, {60, 0.033747}, {70, 0.006727}, {75, 0.001332}};
    for (const auto& at : under_sphere)
        list.add("ball under a spherical light, " + std::to_string(int(at.deg)) + " degrees", ball(lambert(0.5f)),
                 looking_at(slanted(at.deg), slanted(at.deg), 0.4, 0), {sphere({0, 3, 0}, 0.5f, 10)}, 1, at.radiance, 2e-6);
    const Scene white = ground(lambert(1)), gray = ground(lambert(0.5f));
    const std::vector<rt_light> square = {rect(1, 0.5f, 0.5f, 1)};
    const Vec beside = normalized(Vec{1, 0.4, 0.3});
    list.add("under the middle of a unit square", white, looking_at({0, 0, 0}, beside, 2, 0), square, 1, 0.239456);
    list.add("under the edge of a unit square", white, looking_at({0.5, 0, 0}, beside, 2, 0), square, 1, 0.180369);
    list.add("under the corner of a unit square", white, looking_at({0.5, 0, 0.5}, beside, 2, 0), square, 1, 0.138532);
    rt_light disc = light(RT_LIGHT_DISC, {0, 1, 0}, 4);
    disc.radius = 0.5f;
    disc.normal[1] = -1;
    disc.area = float(kPi) * 0.25f;
    list.add("under the middle of a disc", gray, looking_at({0, 0, 0}, beside, 2, 0), {disc}, 1, 0.5 * 4 * 0.2);  // r L sin^2
    // KHR_lights_punctual: 10 candela 2 m above: 2.5 lux; 3 lux at 60 degrees.
    list.add("a point of 10 candela", gray, looking_at({0, 0, 0}, beside, 1, 0),
             {light(RT_LIGHT_POINT, {0, 2, 0}, 10, RT_LIGHT_FALLOFF)}, 1, 0.397887);
    list.add("a directional light of 3 lux", gray, looking_at({0, 0, 0}, beside, 1, 0),
             {light(RT_LIGHT_DIRECTIONAL, slanted(60), 3, RT_LIGHT_FALLOFF)}, 1, 0.238732);
    list.add("Whitted's point without falloff", gray, looking_at({0, 0, 0}, beside, 1, 0),
             {light(RT_LIGHT_POINT, {0, 2, 0}, 1)}, 1, 0.5);
    rt_light spot = light(RT_LIGHT_SPOT, {0, 2, 0}, 10, RT_LIGHT_FALLOFF);
    spot.normal[1] = -1;
    spot.cos_inner = 0.95f;
    spot.cos_outer = 0.9f;
    list.add("within a spot's cone", gray, looking_at({0, 0, 0}, beside, 1, 0), {spot}, 1, 0.397887);
    list.add("outside of a spot's cone", gray, looking_at({1.1, 0, 0}, beside, 1, 0), {spot}, 1, 0);
    for (const double deg : {0.0, 30.0, 60.0})
        list.add("a sun at " + std::to_string(int(deg)) + " degrees", white, looking_at({0, 0, 0}, beside, 1, 0),
                 {sun(deg, 0.533, 1)}, 1, std::cos(deg * kRadPerDegree) / kPi);
    // A straight edge one unit above the ground: what a disc of radius tan a leaves uncovered.
    TriangleMesh edge;
    add_quad(edge, {-50, 1, -50}, {0, 0, 100}, {50, 0, 0});
    Scene shaded = of_mesh(edge, lambert(0));
    shaded.planes.push_back({{0, 1, 0}, 0, add_material(shaded, lambert(1))});
    const double half_width = std::tan(0.2665 * kRadPerDegree);
    for (const auto& [x, lit] : {std::pair<double, double>{-0.5, 0.1955}, {0, 0.5}, {0.5, 0.8045}})
        list.add("penumbra of a sun at " + std::to_string(x), shaded,
                 looking_at({x * half_width, 0, 0}, normalized(Vec{0.3, 0.3, 1}), 1, 0, 0.004), {sun(0, 0.533, 1)}, 1,
                 lit / kPi, 1e-4);
}

void add_rooms(List& list) {
    // Radiosity in double precision, extrapolated: ceiling of radiance 1, five faces of albedo 0.5.
    const std::vector<rt_light> ceiling = {rect(1, 0.5f, 0.5f, 1)};
    const Scene gray = room(lambert(0.5f));
    const View floor = looking_at({0, 0, 0}, normalized(Vec{0.1, 1, 0.1}), 0.4, 0),
               wall = looking_at({-0.5, 0.5, 0}, {1, 0, 0}, 0.4, 0);
    list.add("room, floor, direct", gray, floor, ceiling, 1, 0.1197, 5e-5);
    list.add("room, wall, direct", gray, wall, ceiling, 1, 0.0951, 5e-5);
    list.add("room, floor, two bounces", gray, floor, ceiling, 2, 0.1544, 1e-4);
    list.add("room, wall, two bounces", gray, wall, ceiling, 2, 0.1359, 1e-4);
    list.add("room, floor, all bounces", gray, floor, ceiling, 40, 0.1791, 5e-5);
    list.add("room, wall, all bounces", gray, wall, ceiling, 40, 0.1612, 5e-5);
}

void add_glass(List& list) {
    const std::vector<rt_light> below = {rect(-2, 90, 90, 1, false)};
    const struct {
        double deg, passed, tinted[3];
    } rows[] = {{0, 0.923077, {0.590211, 0.230423, 0.036864}},
                {30, 0.920266, {0.572634, 0.211165, 0.030229}},
                {60, 0.836232, {0.481546, 0.151916, 0.016097}}};
    rt_material dyed = dielectric(1.5f);  // of 0.8, 0.5 and 0.2 half of a unit is left
    for (int c = 0; c < 3; ++c) dyed.absorption[c] = float(-2 * std::log(std::vector<double>{0.8, 0.5, 0.2}[size_t(c)]));
    for (const auto& row : rows) {
        const View view = looking_at({0, 1, 0}, slanted(row.deg), 2, 0);
        list.add("through a slab at " + std::to_string(int(row.deg)) + " degrees", slab(dielectric(1.5f)), view, below, 60,
                 row.passed, 2e-6);
        list.add("through an absorbing slab at " + std::to_string(int(row.deg)) + " degrees", slab(dyed), view, below, 60,
                 Vec{row.tinted[0], row.tinted[1], row.tinted[2]}, 2e-6);
    }
    // Light inside of glass is spread over a larger solid angle outside: (1 - R) L / ior^2.
    list.add("a light in glass, seen from outside", ground(dielectric(1.5f)), looking_at({0, 0, 0}, {0, 1, 0}, 1, 0), below, 8,
             0.96 / 2.25);
    list.add("a light outside, seen from within glass", ground(dielectric(1.5f)), looking_at({0, 0, 0}, {0, -1, 0}, 1, 0),
             {rect(2, 90, 90, 1)}, 8, 0.96 * 2.25);
}

}  // namespace

std::vector<ClosedForm> closed_forms() {
    List list;
    add_furnaces(list);
    add_lights(list);
    add_rooms(list);
    add_glass(list);
    return std::move(list.forms);
}

}  // namespace clarity::reference
