#include "reference.hpp"

#include <cmath>

#include "base/angle.hpp"
#include "import/import.hpp"
#include "support/scratch.hpp"

namespace clarity::test {
namespace {

bool everywhere(const Vec&) {
    return true;
}

std::string text(double number) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, " %.9g", number);
    return buffer;
}
std::string text(const Vec& v) {
    return text(v[0]) + text(v[1]) + text(v[2]);
}

// An axis with a point at its start and two directions across it.
struct Axis {
    Vec from, along, x, y;
    double length;
    Axis(const Vec& a, const Vec& b) : from(a), along(normalized(b - a)), length(clarity::length(b - a)) {
        x = normalized(cross(along, std::fabs(along[0]) < 0.6 ? Vec{1, 0, 0} : Vec{0, 1, 0}));
        y = cross(along, x);
    }
    double z(const Vec& p) const { return dot(p - from, along); }
    double away(const Vec& p) const { return clarity::length(p - from - z(p) * along); }
    Vec point(double radius, double turns, double height) const {
        return from + height * along + radius * std::cos(2 * kPi * turns) * x + radius * std::sin(2 * kPi * turns) * y;
    }
};

ShapeCase box_case() {
    const Vec lo = {-1, -0.5, -0.7}, hi = {0.8, 0.6, 0.9};
    ShapeCase c{"box", "box from" + text(Vec{lo[0], hi[1], lo[2]}) + " to" + text(Vec{hi[0], lo[1], hi[2]}), 1.7, {}, {}};
    c.sheets.push_back({[=](const Vec& p) {
                            double outside = -1e9;
                            for (size_t k = 0; k < 3; ++k) outside = std::fmax(outside, std::fmax(lo[k] - p[k], p[k] - hi[k]));
                            return outside;
                        },
                        everywhere});
    for (size_t k = 0; k < 3; ++k)
        for (const Vec& side : {lo, hi})
            c.faces.push_back([=](double u, double v) {
                Vec p;
                p[k] = side[k];
                p[(k + 1) % 3] = lo[(k + 1) % 3] + u * (hi[(k + 1) % 3] - lo[(k + 1) % 3]);
                p[(k + 2) % 3] = lo[(k + 2) % 3] + v * (hi[(k + 2) % 3] - lo[(k + 2) % 3]);
                return p;
            });
    return c;
}

ShapeCase disc_case() {
    const Vec center = {0.1, 0.2, 0.3}, normal = {1, 2, 0.5};
    const double radius = 1.2, inner = 0.4;
    const Axis axis(center, center + normal);
    ShapeCase c{"disc", "disc center" + text(center) + " normal" + text(normal) + " radius 1.2 inner .4", 1.7, {}, {}};
    c.sheets.push_back({[=](const Vec& p) { return axis.z(p); },
                        [=](const Vec& p) { return axis.away(p) <= radius && axis.away(p) >= inner; }});
    c.faces.push_back([=](double u, double v) { return axis.point(inner + v * (radius - inner), u, 0); });
    return c;
}

// A cone, or a cylinder where both radii are the same.
ShapeCase cone_case(const std::string& word, const std::string& keys, const Vec& from, const Vec& to, double radius, double top,
                    bool caps) {
    const Axis axis(from, to);
    ShapeCase c{word + (caps ? "" : ", open"),
                word + " from" + text(from) + " to" + text(to) + keys + (caps ? "" : " caps 0"),
                2,
                {},
                {}};
    const auto radius_at = [=](const Vec& p) { return radius + (top - radius) * axis.z(p) / axis.length; };
    const auto between = [=](const Vec& p) { return axis.z(p) >= 0 && axis.z(p) <= axis.length; };
    if (caps)
        c.sheets.push_back({[=](const Vec& p) {
                                return std::fmax(axis.away(p) - radius_at(p), std::fmax(-axis.z(p), axis.z(p) - axis.length));
                            },
                            everywhere});
    else
        c.sheets.push_back({[=](const Vec& p) { return axis.away(p) - radius_at(p); }, between});
    c.faces.push_back([=](double u, double v) { return axis.point(radius + v * (top - radius), u, v * axis.length); });
    if (caps) {
        c.faces.push_back([=](double u, double v) { return axis.point(v * radius, u, 0); });
        c.faces.push_back([=](double u, double v) { return axis.point(v * top, u, axis.length); });
    }
    return c;
}

// Spheres are built in, but must agree with a mesh as shapes do.
ShapeCase sphere_case() {
    const Vec center = {0.2, -0.1, 0.3};
    const double radius = 1.1;
    ShapeCase c{"sphere", "sphere center" + text(center) + " radius 1.1", 1.7, {}, {}};
    c.sheets.push_back({[=](const Vec& p) { return length(p - center) - radius; }, everywhere});
    const Axis axis(center, center + Vec{0, 1, 0});
    c.faces.push_back(
        [=](double u, double v) { return axis.point(radius * std::sin(kPi * v), u, radius * std::cos(kPi * v)); });
    return c;
}

ShapeCase torus_case(const std::string& name, const std::string& statement, const Axis& axis, double ring, double tube) {
    ShapeCase c{name, statement, 1.7, {}, {}};
    c.sheets.push_back({[=](const Vec& p) { return std::hypot(axis.away(p) - ring, axis.z(p)) - tube; }, everywhere});
    c.faces.push_back(
        [=](double u, double v) { return axis.point(ring + tube * std::cos(2 * kPi * v), u, tube * std::sin(2 * kPi * v)); });
    return c;
}

// The same torus as a rational surface of degree 2: circles of nine points, of which each second is a corner of a square.
std::string nurbs_torus(double ring, double tube) {
    constexpr double xs[] = {1, 1, 0, -1, -1, -1, 0, 1, 1}, ys[] = {0, 1, 1, 1, 0, -1, -1, -1, 0};
    const auto weight = [](int i) { return i % 2 ? std::sqrt(0.5) : 1.0; };
    std::string points = " points", weights = " weights", knots = " 0 0 0 1 1 2 2 3 3 4 4 4";
    for (int j = 0; j < 9; ++j)
        for (int i = 0; i < 9; ++i) {
            const double away = ring + tube * xs[j];
            points += text(Vec{away * xs[i], away * ys[i], tube * ys[j]});
            weights += text(weight(i) * weight(j));
        }
    return "nurbs degree_u 2 degree_v 2 columns 9" + points + weights + " knots_u" + knots + " knots_v" + knots;
}

// A height field of degree 3 with a hill and a hollow, over the square from -1 to 1. Its x and y are linear in u and v.
constexpr double kHeights[4][4] = {{0, 0.5, -0.8, 0.1}, {0.4, 2.0, -1.2, 0}, {-0.6, -1.5, 2.2, 0.3}, {0, 0.2, 0.4, -0.5}};
double height_at(double u, double v) {
    const auto weight = [](int i, double x) {
        constexpr double binomial[] = {1, 3, 3, 1};
        return binomial[i] * std::pow(x, i) * std::pow(1 - x, 3 - i);
    };
    double sum = 0;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) sum += kHeights[j][i] * weight(i, u) * weight(j, v);
    return sum;
}
ShapeCase hills_case() {
    ShapeCase c{"nurbs, hills", "nurbs points", 2.2, {}, {}};
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) c.statement += text(Vec{2 * i / 3.0 - 1, 2 * j / 3.0 - 1, kHeights[j][i]});
    const auto inside = [](const Vec& p) { return std::fabs(p[0]) <= 1 && std::fabs(p[1]) <= 1; };
    c.sheets.push_back({[](const Vec& p) { return p[2] - height_at((p[0] + 1) / 2, (p[1] + 1) / 2); }, inside});
    c.faces.push_back([](double u, double v) { return Vec{2 * u - 1, 2 * v - 1, height_at(u, v)}; });
    return c;
}

std::array<double, 12> placement(const Vec& translate, const Vec& axis, double degrees, const Vec& scale) {
    const Vec a = normalized(axis);
    const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
    std::array<double, 12> m{};
    const double cross_of[3][3] = {{0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};
    for (size_t i = 0; i < 3; ++i) {
        for (size_t j = 0; j < 3; ++j)
            m[4 * i + j] = ((i == j ? c : 0) + s * cross_of[i][j] + (1 - c) * a[i] * a[j]) * scale[j];
        m[4 * i + 3] = translate[i];
    }
    return m;
}

std::array<double, 12> inverse(const std::array<double, 12>& m) {
    const Vec x = {m[0], m[4], m[8]}, y = {m[1], m[5], m[9]}, z = {m[2], m[6], m[10]}, at = {m[3], m[7], m[11]};
    const double volume = dot(x, cross(y, z));
    std::array<double, 12> back;
    const Vec rows[] = {1 / volume * cross(y, z), 1 / volume * cross(z, x), 1 / volume * cross(x, y)};
    for (size_t i = 0; i < 3; ++i) {
        for (size_t j = 0; j < 3; ++j) back[4 * i + j] = rows[i][j];
        back[4 * i + 3] = -dot(rows[i], at);
    }
    return back;
}

// The first valid change of sign of a sheet on o + t d, t from `from` to `to`.
double first_crossing(const Sheet& sheet, const Vec& o, const Vec& d, double from, double to) {
    constexpr int kSteps = 500;
    const auto at = [&](double t) { return sheet.side(o + t * d); };
    const auto t_of = [&](int i) { return from + (to - from) * i / kSteps; };
    double before = at(t_of(0)), earlier = before;
    const auto crossing = [&](double low, double high) {
        const bool positive = at(low) > 0;
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            ((at(middle) > 0) == positive ? low : high) = middle;
        }
        return sheet.valid(o + high * d) ? high : INFINITY;
    };
    for (int i = 1; i <= kSteps; ++i) {
        const double now = at(t_of(i));
        if ((now > 0) != (before > 0)) {
            const double t = crossing(t_of(i - 1), t_of(i));
            if (t < INFINITY) return t;
        } else if (i > 1 && std::fabs(before) <= std::fabs(earlier) && std::fabs(before) <= std::fabs(now) &&
                   (earlier > 0) == (now > 0)) {
            double low = t_of(i - 2), high = t_of(i);  // a narrow double crossing may hide here
            const double sign = now > 0 ? 1 : -1;
            for (int k = 0; k < 60; ++k) {
                const double a = low + (high - low) / 3, b = high - (high - low) / 3;
                (sign * at(a) < sign * at(b) ? high : low) = sign * at(a) < sign * at(b) ? b : a;
            }
            if (sign * at(low) <= 0) {
                double t = crossing(t_of(i - 2), low);
                if (!(t < INFINITY)) t = crossing(low, t_of(i));
                if (t < INFINITY) return t;
            }
        }
        earlier = before;
        before = now;
    }
    return INFINITY;
}

}  // namespace

const std::vector<ShapeCase>& shape_cases() {
    static const std::vector<ShapeCase> cases = {
        box_case(),
        disc_case(),
        cone_case("cylinder", " radius .6", {-0.5, -0.8, 0.2}, {0.6, 0.7, -0.3}, 0.6, 0.6, true),
        cone_case("cylinder", " radius .6", {-0.5, -0.8, 0.2}, {0.6, 0.7, -0.3}, 0.6, 0.6, false),
        cone_case("cone", " radius .8", {0.2, -0.9, 0.1}, {-0.4, 0.9, -0.2}, 0.8, 0, true),
        cone_case("cone", " radius .9 top .3", {0.1, -0.7, 0.3}, {0.2, 0.6, -0.4}, 0.9, 0.3, true),
        cone_case("cone", " radius .4 top .9", {0.1, -0.7, 0.3}, {0.2, 0.6, -0.4}, 0.4, 0.9, false),
        torus_case("torus", "torus center .1 -.2 .1 normal 1 2 .5 radius 1.1 tube .3", Axis({0.1, -0.2, 0.1}, {1.1, 1.8, 0.6}),
                   1.1, 0.3),
        torus_case("torus, thin", "torus radius 1.5 tube .02", Axis({0, 0, 0}, {0, 1, 0}), 1.5, 0.02),
        torus_case("nurbs, torus", nurbs_torus(1, 0.4), Axis({0, 0, 0}, {0, 0, 1}), 1, 0.4),
        hills_case(),
        sphere_case(),
    };
    return cases;
}

const std::vector<PlacedShape>& placed_shapes() {
    static const std::vector<PlacedShape> all = [] {
        std::vector<PlacedShape> list;
        const std::vector<ShapeCase>& cases = shape_cases();
        const size_t plugins =
            cases.size() - 1;  // the last is a sphere, which keeps its form: its scale must be the same along all axes
        for (size_t i = 0; i < plugins + 3; ++i) {  // the first two once more
            const Vec translate = {6.0 * double(i % 4), 6.0 * double(i / 4), i == 1 ? 40.0 : 0.0}, axis = {1, 2, 3};
            const Vec scale = i % 3 == 2 ? Vec{1, 0.7, 1.3} : i % 3 == 1 ? Vec{0.8, 0.8, 0.8} : Vec{1, 1, 1};
            const double degrees = i == 0 ? 0 : 40.0 * double(i);
            const std::array<double, 12> world = placement(translate, axis, degrees, scale);
            list.push_back({i == plugins + 2 ? &cases.back() : &cases[i % plugins],
                            " translate" + text(translate) + " rotate" + text(axis) + text(degrees) + " scale" + text(scale),
                            world, inverse(world)});
        }
        return list;
    }();
    return all;
}

Vec transformed(const std::array<double, 12>& m, const Vec& p) {
    return {m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3], m[4] * p[0] + m[5] * p[1] + m[6] * p[2] + m[7],
            m[8] * p[0] + m[9] * p[1] + m[10] * p[2] + m[11]};
}

double nearest_hit(const Vec& origin, const Vec& direction, double t_min) {
    double nearest = INFINITY;
    for (const PlacedShape& placed : placed_shapes()) {
        const Vec o = transformed(placed.back, origin), d = transformed(placed.back, origin + direction) - o;
        const double dd = dot(d, d), closest = -dot(o, d) / dd, least2 = dot(o + closest * d, o + closest * d);
        const double room = placed.shape->reach * placed.shape->reach - least2;
        if (room <= 0) continue;
        const double half_way = std::sqrt(room / dd), from = std::fmax(closest - half_way, t_min), to = closest + half_way;
        if (from >= std::fmin(to, nearest)) continue;
        for (const Sheet& sheet : placed.shape->sheets) nearest = std::fmin(nearest, first_crossing(sheet, o, d, from, to));
    }
    return nearest;
}

ScenePtr fine_mesh() {
    constexpr int kAround = 256, kAlong = 96;
    TriangleMesh mesh;
    for (const PlacedShape& placed : placed_shapes())
        for (const Face& face : placed.shape->faces)
            mesh.add_grid({kAlong, kAround, kCut013}, [&](rt_u32 j, rt_u32 i) {
                mesh.add_vertex(transformed(placed.world, face(double(i) / kAround, double(j) / kAlong)));
            });
    return shared_scene(scene_of(mesh));
}

ScenePtr imported_shapes() {
    static const ScenePtr scene = [] {
        const Scratch scratch;
        std::string main;
        for (size_t i = 0; i < placed_shapes().size(); ++i) {
            const PlacedShape& placed = placed_shapes()[i];
            const std::string name = "shape" + std::to_string(i) + ".scene";
            scratch.write(name, placed.shape->statement + "\n");
            main += "load \"" + name + "\"" + placed.placement + "\n";
        }
        Progress progress;
        return std::make_shared<const Scene>(import::import_scene(
            Workbench::get().plugins(), {scratch.write("main.scene", main)}, import::ImportOptions(), progress));
    }();
    return scene;
}

}  // namespace clarity::test
