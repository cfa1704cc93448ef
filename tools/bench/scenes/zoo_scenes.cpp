#include "tools/bench/scenes/zoo_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/angle.hpp"
#include "scene/scene.hpp"
#include "scene/vec.hpp"
#include "stand/made_scenes.hpp"

namespace clarity::bench {
namespace {

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

TriangleMesh mesh_of(const TurnedMesh& grid) {
    TriangleMesh mesh;
    mesh.add_grid({grid.rows, grid.parts, kCut013, false, true, false, grid.is_tip(grid.rows)},
                  [&](rt_u32 row, rt_u32 column) { mesh.add_vertex(grid.at(column, row)); });
    return mesh;
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

// The faces across x first, then those across z last: the order that published figures have.
TriangleMesh box_mesh() {
    TriangleMesh mesh;
    mesh.add_box({-0.8, 0, -0.5}, {0.8, 1.4, 0.5});
    std::swap_ranges(mesh.triangles.begin(), mesh.triangles.begin() + 12, mesh.triangles.end() - 12);
    return mesh;
}

}  // namespace

void add_zoo_scene(const std::string& name, uint64_t triangles, Scene& scene) {
    static constexpr struct {
        const char* name;
        void (*add)(SceneMaker& make, uint64_t triangles);
    } kRows[] = {{"stadium", made::stadium},
                 {"hair", made::hair},
                 {"city", made::city},
                 {"height field", made::height_field},
                 {"soup", made::soup}};
    for (const auto& row : kRows) {
        if (name != row.name) continue;
        SceneMaker make(0, std::move(scene));
        row.add(make, triangles);
        make.place_mesh();
        scene = std::move(make.scene);
        return;
    }
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

std::string shape_mesh_name(const std::string& name, unsigned parts) {
    return name + ", " + std::to_string(parts) + (parts == 1 ? " part" : " parts");
}

double shape_mesh_error(const std::string& name, unsigned parts) {
    const Turned* const shape = turned_shape(name);
    return shape ? error_of(TurnedMesh(*shape, parts)) : 0;
}

double add_shape_mesh(const std::string& name, unsigned parts, Scene& scene) {
    const Turned* const shape = turned_shape(name);
    if (!shape && name != "box") throw std::out_of_range("no shape `" + name + "` has a mesh");
    place(scene, add_mesh(scene, shape ? mesh_of(TurnedMesh(*shape, parts)) : box_mesh()));
    return shape_mesh_error(name, parts);
}

}  // namespace clarity::bench
