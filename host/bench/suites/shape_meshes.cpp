#include "bench/suites/shape_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/angle.hpp"
#include "bench/suites/mesh_writer.hpp"

namespace clarity::bench {
namespace {

constexpr double kWholeTurn = 2 * kPi;

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
    return {0.8 + 0.3 * std::cos(kWholeTurn * v), 0.7 - 0.3 * std::sin(kWholeTurn * v)};
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
    return {at.radius * std::cos(kWholeTurn * u), at.height, -at.radius * std::sin(kWholeTurn * u)};
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
