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

double add_turned(const Turned& shape, unsigned parts, Scene& scene) {
    const auto rows = std::max(1u, static_cast<unsigned>(std::lround(shape.rows_per_part * parts)));
    const auto at = [&](double column, double row) { return turned_point(shape, column / parts, row / rows); };
    MeshWriter mesh(scene);
    std::vector<rt_u32> before, here;
    for (unsigned row = 0; row <= rows; ++row, std::swap(before, here)) {
        here.clear();
        for (unsigned column = 0; column < parts; ++column) here.push_back(mesh.vertex(at(column, row)));
        const bool tip = shape.at(double(row) / rows).radius == 0;
        for (unsigned column = 0; column < parts && row > 0; ++column) {
            const unsigned next = (column + 1) % parts;
            mesh.triangle(before[column], before[next], here[next]);
            if (!tip) mesh.triangle(before[column], here[next], here[column]);
        }
    }
    mesh.end_and_place();
    double error = 0;  // the same in all columns
    for (unsigned row = 0; row < rows; ++row) {
        const auto edge = [&](double c0, double r0, double c1, double r1) {
            const Vec middle = 0.5 * (at(c0, r0) + at(c1, r1));
            error = std::max(error, length(middle - at(0.5 * (c0 + c1), 0.5 * (r0 + r1))));
        };
        edge(0, row, 1, row);
        edge(0, row, 0, row + 1);
        // At a tip all columns meet.
        if (shape.at(double(row + 1) / rows).radius > 0) edge(0, row, 1, row + 1);
    }
    return error;
}

double add_box(Scene& scene) {
    MeshWriter mesh(scene);
    rt_u32 corners[8];
    for (int i = 0; i < 8; ++i) corners[i] = mesh.vertex({i & 1 ? 0.8 : -0.8, i & 2 ? 1.4 : 0, i & 4 ? 0.5 : -0.5});
    constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : kFaces) {
        mesh.triangle(corners[f[0]], corners[f[1]], corners[f[2]]);
        mesh.triangle(corners[f[0]], corners[f[2]], corners[f[3]]);
    }
    mesh.end_and_place();
    return 0;
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

double add_shape_mesh(const std::string& name, unsigned parts, Scene& scene) {
    if (name == "box") return add_box(scene);
    for (const Turned& shape : kTurned)
        if (name == shape.name) return add_turned(shape, std::max(3u, parts), scene);
    throw std::out_of_range("no shape `" + name + "` has a mesh");
}

}  // namespace clarity::bench
