#include "tools/bench/scenes/zoo_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/angle.hpp"
#include "scene/scene.hpp"
#include "scene/vec.hpp"
#include "tools/bench/scenes/ray_sets.hpp"

namespace clarity::bench {
namespace {

// Writes meshes that are computed into a scene.

// A mesh that grows at the end of the scene's arrays.
class MeshWriter {
 public:
    explicit MeshWriter(Scene& scene) : scene_(scene) {
        if (scene.materials.empty()) scene.materials.push_back({"default", default_material()});
        mesh_.first_vertex = scene.vertex_count();
        mesh_.first_triangle = scene.triangle_count();
    }
    rt_u32 vertex(const Vec& p) {
        for (int k = 0; k < 3; ++k) scene_.positions.push_back(static_cast<float>(p[k]));
        return mesh_.first_vertex + mesh_.vertex_count++;
    }
    void triangle(rt_u32 a, rt_u32 b, rt_u32 c) {
        for (const rt_u32 v : {a, b, c}) scene_.triangles.push_back(v);
        scene_.triangle_materials.push_back(0);
        ++mesh_.triangle_count;
        ++mesh_.polygon_count;
    }
    void quad(const Vec& a, const Vec& b, const Vec& c, const Vec& d) {
        const rt_u32 first = vertex(a);
        vertex(b), vertex(c), vertex(d);
        triangle(first, first + 1, first + 2);
        triangle(first, first + 2, first + 3);
    }
    rt_u32 triangles() const { return mesh_.triangle_count; }
    // Ends the mesh. Returns its number.
    rt_u32 end() {
        scene_.meshes.push_back(mesh_);
        return static_cast<rt_u32>(scene_.meshes.size() - 1);
    }
    void end_and_place() { place(scene_, end(), kIdentity); }
    static void place(Scene& scene, rt_u32 mesh, const Affine& at) {
        Instance instance;
        instance.mesh = mesh;
        instance.world_from_object = at;
        scene.instances.push_back(instance);
    }

 private:
    Scene& scene_;
    Mesh mesh_;
};

// Numbers from 0 to 1 by a counter.
class Chance {
 public:
    double operator()() { return lowbias32(++count_) / 4294967296.0; }
    double between(double a, double b) { return a + (b - a) * (*this)(); }
    Vec direction() {
        const double z = between(-1, 1), angle = between(0, kTurn), r = std::sqrt(std::max(0.0, 1 - z * z));
        return {r * std::cos(angle), r * std::sin(angle), z};
    }

 private:
    uint32_t count_ = 0;
};

void add_stadium(uint64_t triangles, Scene& scene) {
    const Bounds box = scene.bounds();
    Vec middle{};
    double size = 1;
    if (!box.empty) {
        size = 0;
        for (int k = 0; k < 3; ++k) {
            middle[k] = 0.5 * (double(box.min[k]) + box.max[k]);
            size = std::max(size, double(box.max[k]) - box.min[k]);
        }
        middle[1] = box.min[1];
    }
    MeshWriter mesh(scene);
    const auto at = [&](double radius, double angle, double height) {
        return middle + size * Vec{1.3 * radius * std::cos(angle), height, radius * std::sin(angle)};
    };
    const unsigned tiers = 24;
    const auto parts = static_cast<unsigned>(std::clamp<uint64_t>(triangles / (4 * tiers), 12, 4096));
    // The pitch is two triangles, and its corners are under the stands. A fan of slivers around the middle would put hundreds
    // of boxes over one another exactly where the camera looks.
    const auto corner = [&](double x, double z) { return middle + size * Vec{52 * x, 0, 40 * z}; };
    mesh.quad(corner(-1, -1), corner(-1, 1), corner(1, 1), corner(1, -1));
    for (unsigned i = 0; i < parts; ++i) {
        const double a = kTurn * i / parts, b = kTurn * (i + 1) / parts;
        for (unsigned t = 0; t < tiers; ++t) {  // a step's front and its seat
            const double r = 40 + 2.5 * t, h = 1.2 * t;
            mesh.quad(at(r, a, h), at(r, b, h), at(r, b, h + 1.2), at(r, a, h + 1.2));
            mesh.quad(at(r, a, h + 1.2), at(r, b, h + 1.2), at(r + 2.5, b, h + 1.2), at(r + 2.5, a, h + 1.2));
        }
    }
    mesh.end_and_place();
}

void add_hair(uint64_t triangles, Scene& scene) {
    constexpr unsigned kPieces = 8;
    constexpr double kWidth = 0.0025;
    Chance chance;
    MeshWriter mesh(scene);
    for (uint64_t strand = 0; strand < std::max<uint64_t>(1, triangles / (2 * kPieces)); ++strand) {
        Vec at = chance.direction(), along = clarity::normalized(at + 0.5 * chance.direction());
        const Vec side = kWidth * clarity::normalized(cross(along, chance.direction()));
        rt_u32 left = mesh.vertex(at - side), right = mesh.vertex(at + side);
        for (unsigned piece = 0; piece < kPieces; ++piece) {
            at = at + (1.0 / kPieces) * along;
            along = clarity::normalized(along + 0.15 * chance.direction() + Vec{0, -0.15, 0});
            const double rest = 1 - double(piece + 1) / kPieces;  // it ends in a point
            const rt_u32 next_left = mesh.vertex(at - rest * side), next_right = mesh.vertex(at + rest * side);
            mesh.triangle(left, right, next_right);
            if (rest > 0) mesh.triangle(left, next_right, next_left);
            left = next_left, right = next_right;
        }
    }
    mesh.end_and_place();
}

void add_city(uint64_t triangles, Scene& scene) {
    constexpr unsigned kKinds = 4, kLots = 40;
    Chance chance;
    rt_u32 houses[kKinds];
    for (rt_u32& house : houses) {
        MeshWriter mesh(scene);
        const auto floors = static_cast<unsigned>(std::clamp<uint64_t>(triangles / (64 * kKinds), 2, 4096));
        const double height = chance.between(1.5, 5);
        // Each floor has a window on each side, which is set back: four bands of wall around it, and its pane.
        for (unsigned f = 0; f < floors; ++f) {
            const double low = height * f / floors, high = height * (f + 1) / floors, sill = low + 0.25 * (high - low),
                         lintel = high - 0.2 * (high - low);
            for (unsigned s = 0; s < 4; ++s) {
                const double c = std::cos(kTurn * s / 4), n = std::sin(kTurn * s / 4);
                const auto at = [&](double x, double y, double out) { return Vec{c * out - n * x, y, n * out + c * x}; };
                mesh.quad(at(-0.35, low, 0.35), at(0.35, low, 0.35), at(0.35, sill, 0.35), at(-0.35, sill, 0.35));
                mesh.quad(at(-0.35, lintel, 0.35), at(0.35, lintel, 0.35), at(0.35, high, 0.35), at(-0.35, high, 0.35));
                mesh.quad(at(-0.35, sill, 0.35), at(-0.2, sill, 0.35), at(-0.2, lintel, 0.35), at(-0.35, lintel, 0.35));
                mesh.quad(at(0.2, sill, 0.35), at(0.35, sill, 0.35), at(0.35, lintel, 0.35), at(0.2, lintel, 0.35));
                mesh.quad(at(-0.2, sill, 0.32), at(0.2, sill, 0.32), at(0.2, lintel, 0.32), at(-0.2, lintel, 0.32));
                mesh.quad(at(-0.2, sill, 0.35), at(0.2, sill, 0.35), at(0.2, sill, 0.32), at(-0.2, sill, 0.32));
                mesh.quad(at(-0.2, lintel, 0.32), at(0.2, lintel, 0.32), at(0.2, lintel, 0.35), at(-0.2, lintel, 0.35));
                mesh.quad(at(-0.2, sill, 0.35), at(-0.2, sill, 0.32), at(-0.2, lintel, 0.32), at(-0.2, lintel, 0.35));
            }
        }
        mesh.quad({-0.35, height, -0.35}, {-0.35, height, 0.35}, {0.35, height, 0.35}, {0.35, height, -0.35});
        house = mesh.end();
    }
    for (unsigned x = 0; x < kLots; ++x)
        for (unsigned z = 0; z < kLots; ++z) {
            const double tall = chance.between(0.4, 1.4),
                         turn = kTurn / 4 * std::floor(chance.between(0, 4)) + chance.between(-0.1, 0.1);
            Affine at = kIdentity;
            at[0] = at[10] = static_cast<float>(std::cos(turn));
            at[2] = static_cast<float>(std::sin(turn));
            at[8] = -at[2];
            at[5] = static_cast<float>(tall);
            at[3] = static_cast<float>(x) - 0.5f * kLots;
            at[11] = static_cast<float>(z) - 0.5f * kLots;
            MeshWriter::place(scene, houses[static_cast<size_t>(chance.between(0, kKinds))], at);
        }
    MeshWriter ground(scene);
    ground.quad({-30, 0, -30}, {-30, 0, 30}, {30, 0, 30}, {30, 0, -30});
    ground.end_and_place();
}

// Sums of sines in several directions, each octave half as high and twice as fine.
double height_at(double x, double z) {
    double sum = 0;
    for (int octave = 0; octave < 7; ++octave) {
        const double turn = 1.1 * octave, f = 1.3 * (1 << octave);
        const double u = std::cos(turn) * x - std::sin(turn) * z, v = std::sin(turn) * x + std::cos(turn) * z;
        sum += std::sin(f * u + octave) * std::sin(f * v - 2 * octave) / (1 << octave);
    }
    return 0.35 * sum;
}

void add_height_field(uint64_t triangles, Scene& scene) {
    MeshWriter mesh(scene);
    const auto side = static_cast<rt_u32>(std::clamp(std::sqrt(0.5 * double(triangles)), 1.0, 30000.0));
    for (rt_u32 i = 0; i <= side; ++i)
        for (rt_u32 k = 0; k <= side; ++k) {
            const double x = 4.0 * k / side - 2, z = 4.0 * i / side - 2;
            const rt_u32 here = mesh.vertex({x, height_at(x, z), z});
            if (i == 0 || k == 0) continue;
            const rt_u32 before = here - side - 1;
            mesh.triangle(before - 1, here - 1, here);
            mesh.triangle(before - 1, here, before);
        }
    mesh.end_and_place();
}

void add_soup(uint64_t triangles, Scene& scene) {
    Chance chance;
    MeshWriter mesh(scene);
    const double size = 2 / std::cbrt(double(std::max<uint64_t>(1, triangles)));
    for (uint64_t i = 0; i < triangles; ++i) {
        const Vec at{chance.between(-1, 1), chance.between(-1, 1), chance.between(-1, 1)};
        rt_u32 corners[3];
        for (rt_u32& corner : corners) corner = mesh.vertex(at + size * chance.direction());
        mesh.triangle(corners[0], corners[1], corners[2]);
    }
    mesh.end_and_place();
}

// A point of a profile that is turned around the y axis.
struct ProfilePoint {
    double radius, height;
};
ProfilePoint cylinder_at(double v) {
    return {0.8, 1.6 * v};
}
ProfilePoint cone_at(double v) {
    return {0.9 * (1 - v), 1.6 * v};
}
ProfilePoint torus_at(double v) {
    return {0.8 + 0.3 * std::cos(kTurn * v), 0.7 - 0.3 * std::sin(kTurn * v)};
}
// The vase: a curve of Bezier, degree 3.
ProfilePoint nurbs_at(double v) {
    constexpr ProfilePoint kPoints[4] = {{0.6, 0}, {1.1, 0.5}, {0.2, 1.1}, {0.5, 1.6}};
    const double w = 1 - v, weights[4] = {w * w * w, 3 * w * w * v, 3 * w * v * v, v * v * v};
    ProfilePoint at{0, 0};
    for (int i = 0; i < 4; ++i) at.radius += weights[i] * kPoints[i].radius, at.height += weights[i] * kPoints[i].height;
    return at;
}

struct Turned {
    const char* name;
    ProfilePoint (*at)(double v);  // v from 0 to 1
    double rows_per_part;          // along the profile; 0: it is straight
};
constexpr Turned kTurned[] = {
    {"cylinder", cylinder_at, 0}, {"cone", cone_at, 0}, {"torus", torus_at, 0.5}, {"nurbs", nurbs_at, 0.25}};

Vec turned_point(const Turned& shape, double u, double v) {
    const ProfilePoint at = shape.at(v);
    return {at.radius * std::cos(kTurn * u), at.height, -at.radius * std::sin(kTurn * u)};
}

// A mesh of a turned profile.
struct TurnedMesh {
    const Turned& shape;
    const unsigned parts, rows;  // around the axis, along the profile

    TurnedMesh(const Turned& turned, unsigned wanted)
        : shape(turned),
          parts(std::max(3u, wanted)),
          rows(std::max(1u, static_cast<unsigned>(std::lround(turned.rows_per_part * parts)))) {}
    Vec at(double column, double row) const { return turned_point(shape, column / parts, row / rows); }
    // All columns meet there.
    bool is_tip(unsigned row) const { return shape.at(double(row) / rows).radius == 0; }
};

void add_turned(const TurnedMesh& grid, Scene& scene) {
    MeshWriter mesh(scene);
    std::vector<rt_u32> before, here;
    for (unsigned row = 0; row <= grid.rows; ++row, std::swap(before, here)) {
        here.clear();
        for (unsigned column = 0; column < grid.parts; ++column) here.push_back(mesh.vertex(grid.at(column, row)));
        for (unsigned column = 0; column < grid.parts && row > 0; ++column) {
            const unsigned next = (column + 1) % grid.parts;
            mesh.triangle(before[column], before[next], here[next]);
            if (!grid.is_tip(row)) mesh.triangle(before[column], here[next], here[column]);
        }
    }
    mesh.end_and_place();
}

double error_of(const TurnedMesh& grid) {
    double error = 0;  // the same in all columns
    for (unsigned row = 0; row < grid.rows; ++row) {
        const auto edge = [&](double c0, double r0, double c1, double r1) {
            const Vec middle = 0.5 * (grid.at(c0, r0) + grid.at(c1, r1));
            error = std::max(error, length(middle - grid.at(0.5 * (c0 + c1), 0.5 * (r0 + r1))));
        };
        edge(0, row, 1, row);
        edge(0, row, 0, row + 1);
        if (!grid.is_tip(row + 1)) edge(0, row, 1, row + 1);
    }
    return error;
}

const Turned* turned_shape(const std::string& name) {
    for (const Turned& shape : kTurned)
        if (name == shape.name) return &shape;
    return nullptr;
}

void add_box(Scene& scene) {
    MeshWriter mesh(scene);
    rt_u32 corners[8];
    for (int i = 0; i < 8; ++i) corners[i] = mesh.vertex({i & 1 ? 0.8 : -0.8, i & 2 ? 1.4 : 0, i & 4 ? 0.5 : -0.5});
    constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : kFaces) {
        mesh.triangle(corners[f[0]], corners[f[1]], corners[f[2]]);
        mesh.triangle(corners[f[0]], corners[f[2]], corners[f[3]]);
    }
    mesh.end_and_place();
}

}  // namespace

void add_zoo_scene(const std::string& name, uint64_t triangles, Scene& scene) {
    static constexpr struct {
        const char* name;
        void (*add)(uint64_t triangles, Scene& scene);
    } kRows[] = {{"stadium", add_stadium},
                 {"hair", add_hair},
                 {"city", add_city},
                 {"height field", add_height_field},
                 {"soup", add_soup}};
    for (const auto& row : kRows)
        if (name == row.name) return row.add(triangles, scene);
    throw std::out_of_range("no scene `" + name + "`");
}

const std::vector<MeshedShape>& meshed_shapes() {
    static const std::vector<MeshedShape> kinds = {{"box", {1}},
                                                   {"cylinder", {8, 32, 128, 512, 2048}},
                                                   {"cone", {8, 32, 128, 512, 2048}},
                                                   {"torus", {8, 32, 128, 512}},
                                                   {"nurbs", {8, 32, 128, 512}}};
    return kinds;
}

double shape_mesh_error(const std::string& name, unsigned parts) {
    const Turned* const shape = turned_shape(name);
    return shape ? error_of(TurnedMesh(*shape, parts)) : 0;
}

double add_shape_mesh(const std::string& name, unsigned parts, Scene& scene) {
    const Turned* const shape = turned_shape(name);
    if (shape)
        add_turned(TurnedMesh(*shape, parts), scene);
    else if (name == "box")
        add_box(scene);
    else
        throw std::out_of_range("no shape `" + name + "` has a mesh");
    return shape_mesh_error(name, parts);
}

}  // namespace clarity::bench
