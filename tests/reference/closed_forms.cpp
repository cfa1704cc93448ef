#include "reference/closed_forms.hpp"

#include <algorithm>
#include <array>

#include "base/angle.hpp"
#include "reference/closed_form_parts.hpp"

namespace clarity::reference {
namespace {

using namespace parts;
using test::add_material;

class List {
 public:
    std::vector<ClosedForm> forms;
    // Begins a table of forms, whose largest value is what a deviation is measured by.
    void begin(const std::string& group) {
        close();
        group_ = group;
    }
    void close() {
        double largest = 0;
        for (size_t i = first_; i < forms.size(); ++i)
            for (const double value : forms[i].expected) largest = std::max(largest, value);
        for (; first_ < forms.size(); ++first_) forms[first_].largest = largest;
    }
    ClosedForm& add(const std::string& name, const Scene& scene, View view, const std::vector<rt_light>& lights, unsigned depth,
                    const Vec& expected, double rounding = 1e-5) {
        view.lights = lights;
        forms.push_back({group_, name, scene, std::move(view), depth, expected, rounding});
        return forms.back();
    }
    ClosedForm& add(const std::string& name, const Scene& scene, View view, const std::vector<rt_light>& lights, unsigned depth,
                    double expected, double rounding = 1e-5) {
        return add(name, scene, std::move(view), lights, depth, Vec{expected, expected, expected}, rounding);
    }

 private:
    std::string group_;
    size_t first_ = 0;  // of the table
};

// A sphere whose wall of albedo r is lit by a cap of its own that covers the share f of it and sends L. Every point of the wall
// gets r L f, and (1 - f) r of that at each further bounce. The disc below the cap sends what the cap would.
void add_integrating_spheres(List& list) {
    for (const auto& [f, r, sent] : {std::array<float, 3>{0.1f, 0.8f, 10}, {0.01f, 0.5f, 100}}) {
        list.begin("furnaces");
        const float height = 1 - 2 * f;
        const std::vector<rt_light> cap = {disc(height, std::sqrt(1 - height * height), sent)};
        const View wall = looking_at({0, -1, 0}, {0, 1, 0}, 1.2, 0, 60);
        double light = double(r) * sent * f;
        const std::string name = "integrating sphere of albedo " + text(r) + ", ";
        for (int bounce = 1; bounce < 5; ++bounce, light *= double(r) * (1 - f))
            list.add(name + "bounce " + std::to_string(bounce), ball(lambert(r)), wall, cap, unsigned(bounce), light).bounce =
                bounce;
        list.add(name + "all bounces", ball(lambert(r)), wall, cap, 64, double(r) * sent * f / (1 - double(r) * (1 - f)));
    }
}

void add_furnaces(List& list) {
    list.begin("furnaces");
    // Inside of a closed body that emits 1, n events leave (1 - r^(n+1)) / (1 - r).
    View inside = looking_at({0.3, 0, 0}, {1, 0, 0}, 0.2, 0, 40);
    for (const double r : {0.5, 0.8}) {
        list.begin("furnaces");
        for (const unsigned n : {1u, 2u, 4u, 8u, 64u})
            list.add("furnace of albedo " + text(r) + ", " + std::to_string(n) + " events", ball(lambert(float(r), 1)), inside,
                     {}, n, (1 - std::pow(r, n + 1)) / (1 - r));
    }
    add_integrating_spheres(list);
    list.begin("furnaces");
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
    list.add("metal of roughness 0.5 that scatters once, cosine 0.5",
             ground(material(RT_MODEL_CONDUCTOR, 1, 0.5f, RT_MATERIAL_SINGLE_SCATTER)),
             looking_at({0, 0, 0}, slanted(60), 3, 1), {}, 1, 0.8573, 1e-4);
    for (const auto& [roughness, albedo] : {std::pair<float, double>{0.5f, 0.8823}, {1.0f, 0.4091}})
        list.add("ball of metal of roughness " + text(roughness) + " that scatters once",
                 ball(material(RT_MODEL_CONDUCTOR, 1, roughness, RT_MATERIAL_SINGLE_SCATTER)), whole_ball(), {}, 1,
                 with_corners(albedo), 1e-4)
            .varies = true;
    rt_material mixture = material(RT_MODEL_WHITTED, 0.5f);
    mixture.reflect = 0.3f;
    list.add("Whitted's mixture under a uniform sky", ground(mixture), looking_at({0, 0, 0}, slanted(40), 3, 1), {}, 3, 0.65);
}

void add_lights(List& list) {
    list.begin("lights");
    // A ball of albedo 0.5 under a spherical light of radiance 10 and radius 0.5, 3 above: r L R^2 cos / d^2; by quadrature
    // where the horizon cuts the light. Angles from the top.
    const struct {
        double deg, radiance;
    } under_sphere[] = {{0, 0.3125},    {15, 0.275164}, {30, 0.189725}, {45, 0.101462}, {60, 0.033747},
                        {65, 0.017472}, {70, 0.006727}, {75, 0.001332}, {80, 0.000002}};
    for (const auto& at : under_sphere)
        list.add("ball under a spherical light, " + std::to_string(int(at.deg)) + " degrees", ball(lambert(0.5f)),
                 looking_at(slanted(at.deg), slanted(at.deg), 0.4, 0), {sphere({0, 3, 0}, 0.5f, 10)}, 1, at.radiance, 2e-6);
    list.begin("lights");
    const Scene white = ground(lambert(1)), gray = ground(lambert(0.5f));
    const std::vector<rt_light> square = {rect(1, 0.5f, 0.5f, 1)};
    const Vec beside = normalized(Vec{1, 0.4, 0.3});
    list.add("under the middle of a unit square", white, looking_at({0, 0, 0}, beside, 2, 0), square, 1, 0.239456);
    list.add("under the edge of a unit square", white, looking_at({0.5, 0, 0}, beside, 2, 0), square, 1, 0.180369);
    list.add("under the corner of a unit square", white, looking_at({0.5, 0, 0.5}, beside, 2, 0), square, 1, 0.138532);
    // Form factors of squares that face each other, and that share an edge.
    list.add("mean of a floor under a ceiling", room(lambert(1)), of_face({0, 0, 0}, {0, 1, 0}), square, 1, 0.199825).varies =
        true;
    list.add("mean of a wall beside a ceiling", room(lambert(1)), of_face({-0.5, 0.5, 0}, {1, 0, 0}), square, 1, 0.200044)
        .varies = true;
    list.begin("lights");
    list.add("under the middle of a disc", gray, looking_at({0, 0, 0}, beside, 2, 0), {disc(1, 0.5f, 4)}, 1,
             0.5 * 4 * 0.2);  // r L sin^2
    list.begin("lights");
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
    list.begin("lights");
    for (const double deg : {0.0, 30.0, 60.0})
        list.add("a sun at " + std::to_string(int(deg)) + " degrees", white, looking_at({0, 0, 0}, beside, 1, 0),
                 {sun(deg, 0.533, 1)}, 1, std::cos(deg * kRadPerDegree) / kPi);
    // A straight edge one unit above the ground: what a disc of radius tan a leaves uncovered.
    TriangleMesh edge;
    add_quad(edge, {-50, 1, -50}, {0, 0, 100}, {50, 0, 0});
    Scene shaded = of_mesh(edge, lambert(0));
    shaded.planes.push_back({{0, 1, 0}, 0, add_material(shaded, lambert(1))});
    const double half_width = std::tan(0.2665 * kRadPerDegree);
    for (const auto& [x, lit] : std::vector<std::pair<double, double>>{
             {-0.75, 0.0721}, {-0.5, 0.1955}, {-0.25, 0.3425}, {0, 0.5}, {0.25, 0.6575}, {0.5, 0.8045}, {0.75, 0.9279}})
        list.add("penumbra of a sun at " + text(x), shaded,
                 looking_at({x * half_width, 0, 0}, normalized(Vec{0.3, 0.3, 1}), 1, 0, 0.004), {sun(0, 0.533, 1)}, 1,
                 lit / kPi, 1e-4);
}

void add_skies(List& list) {
    list.begin("skies");
    const Vec beside = normalized(Vec{1, 0.4, 0.3});
    const View above = looking_at({0, 0, 0}, beside, 2, 0);
    const Scene white = ground(lambert(1));
    list.add("ground under a uniform sky", white, looking_at({0, 0, 0}, beside, 2, 1), {}, 1, 1);
    Scene wall = white;
    wall.planes[0].normal = {1, 0, 0};
    list.add("wall under half a sky", under_gradient(wall, 1, 1), above, {}, 1, 0.5);
    list.add("ground under a gradient", under_gradient(white, 1, 0.2f), above, {}, 1, 0.733333);
    list.add("ground under an overcast sky", under_gradient(white, 1, 1.0f / 3), above, {}, 1, 0.777778);
    const struct {
        double n, light[5];  // at 0, 30, 60, 80 and 90 degrees
    } rows[] = {{1, {0.666667, 0.587229, 0.405999, 0.273297, 0.212207}},
                {20, {0.090909, 0.078730, 0.045501, 0.018213, 0.008009}},
                {500, {0.003984, 0.003450, 0.001992, 0.000692, 0.000071}}};
    for (const auto& row : rows) {
        list.begin("skies");
        for (int k = 0; k < 5; ++k) {
            const double deg = std::array<double, 5>{0, 30, 60, 80, 90}[size_t(k)];
            const rt_u32 height = row.n > 100 && deg == 0 ? 512 : 256;
            // Straight lines between rows hold more than the lobe, which cancels but at a pole.
            const double at_pole = deg == 0 ? row.n * std::pow(kPi / height, 2) / 12 : 0;
            list.add("lobe of exponent " + text(row.n) + " at " + text(deg) + " degrees", under_lobe(white, deg, row.n, height),
                     above, {}, 1, row.light[k], (0.0005 + at_pole) * row.light[k] + 5e-7);
        }
    }
}

void add_rooms(List& list) {
    list.begin("rooms");
    // Radiosity in double precision, extrapolated: ceiling of radiance 1, five faces of albedo 0.5.
    const std::vector<rt_light> ceiling = {rect(1, 0.5f, 0.5f, 1)};
    const Scene gray = room(lambert(0.5f));
    const View floor = looking_at({0, 0, 0}, normalized(Vec{0.1, 1, 0.1}), 0.4, 0),
               wall = looking_at({-0.5, 0.5, 0}, {1, 0, 0}, 0.4, 0);
    const View floors = of_face({0, 0, 0}, {0, 1, 0}), walls = of_face({-0.5, 0.5, 0}, {1, 0, 0});
    const struct {
        const char* name;
        unsigned depth;
        int bounce;
        double floor, wall, floors, walls;  // middles and means
    } rows[] = {{"direct", 1, -1, 0.1197, 0.0951, 0.0999, 0.1000},
                {"second bounce", 2, 2, 0.0347, 0.0408, 0.0294, 0.0392},
                {"all bounces", 40, -1, 0.1791, 0.1612, 0.1552, 0.1640}};
    for (const auto& row : rows) {
        const auto add = [&](const char* place, const View& view, double light, bool varies) {
            ClosedForm& form =
                list.add(std::string("room, ") + place + ", " + row.name, gray, view, ceiling, row.depth, light, 5e-5);
            form.bounce = row.bounce;
            form.varies = varies;
        };
        add("floor", floor, row.floor, false);
        add("wall", wall, row.wall, false);
        add("mean of the floor", floors, row.floors, true);
        add("mean of a wall", walls, row.walls, true);
    }
}

void add_glass(List& list) {
    list.begin("glass");
    const std::vector<rt_light> below = {rect(-2, 90, 90, 1, false)}, above = {rect(4, 90, 90, 1)};
    const struct {
        double deg, face, passed;  // what one face mirrors, and what passes a slab, with all reflections inside
    } rows[] = {{0, 0.040000, 0.923077},  {30, 0.041523, 0.920266}, {45, 0.050240, 0.904327}, {60, 0.089187, 0.836232},
                {70, 0.171043, 0.707880}, {80, 0.387704, 0.441229}, {85, 0.612800, 0.240080}};
    for (const auto& row : rows) {
        const std::string at = " at " + text(row.deg) + " degrees";
        const View view = looking_at({0, 1, 0}, slanted(row.deg), 2, 0);
        list.add("through a slab" + at, slab(dielectric(1.5f)), view, below, 60, row.passed, 2e-6);
        list.add("mirrored by a slab" + at, slab(dielectric(1.5f)), view, above, 60, 1 - row.passed, 2e-6);
        list.add("mirrored by a face" + at, ground(dielectric(1.5f)), looking_at({0, 0, 0}, slanted(row.deg), 2, 0), above, 8,
                 row.face, 2e-6);
    }
    rt_material black = dielectric(1.5f);
    for (float& a : black.absorption) a = 1e4f;
    list.add("mirrored by a ball that is dark inside", ball(black), whole_ball(), {}, 8, with_corners(0.091778)).varies = true;

    list.begin("glass");
    const struct {
        double deg, passed[3], mirrored[3];
    } tints[] = {{0, {0.590211, 0.230423, 0.036864}, {0.055109, 0.042304, 0.040059}},
                 {30, {0.572634, 0.211165, 0.030229}, {0.056334, 0.043538, 0.041564}},
                 {60, {0.481546, 0.151916, 0.016097}, {0.114050, 0.091667, 0.089215}}};
    rt_material dyed = dielectric(1.5f);  // of 0.8, 0.5 and 0.2 half of a unit is left
    for (int c = 0; c < 3; ++c) dyed.absorption[c] = float(-2 * std::log(std::vector<double>{0.8, 0.5, 0.2}[size_t(c)]));
    for (const auto& row : tints) {
        const std::string at = " at " + text(row.deg) + " degrees";
        const View view = looking_at({0, 1, 0}, slanted(row.deg), 2, 0);
        list.add("through an absorbing slab" + at, slab(dyed), view, below, 60,
                 Vec{row.passed[0], row.passed[1], row.passed[2]}, 2e-6);
        list.add("mirrored by an absorbing slab" + at, slab(dyed), view, above, 60,
                 Vec{row.mirrored[0], row.mirrored[1], row.mirrored[2]}, 2e-6);
    }
    dyed.ior = 1;
    list.add("through a slab that absorbs and does not bend", slab(dyed), looking_at({0, 1, 0}, {0, 1, 0}, 2, 0), below, 8,
             Vec{0.64, 0.25, 0.04}, 2e-6);
    list.begin("glass");
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
    add_skies(list);
    add_rooms(list);
    add_glass(list);
    list.close();
    return std::move(list.forms);
}

}  // namespace clarity::reference
