#include "stand/triangle_mesh.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "base/angle.hpp"

namespace clarity {
namespace {

template <class T>
void append(SharedArray<T>& to, std::vector<T>&& from) {
    if (to.empty() && !from.empty())
        to = SharedArray<T>(std::move(from));
    else if (!from.empty())
        to.append(from.begin(), from.end());
}

}  // namespace

bool TriangleMesh::is_closed() const {
    std::map<std::pair<rt_u32, rt_u32>, int> edges;
    for (size_t i = 0; i < triangles.size(); i += 3)
        for (int k = 0; k < 3; ++k) ++edges[{triangles[i + k], triangles[i + (k + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
        const auto back = edges.find({edge.second, edge.first});
        if (count != 1 || back == edges.end() || back->second != 1) return false;
    }
    return !edges.empty();
}

rt_u32 TriangleMesh::add_vertex(const Vec& at) {
    for (const double c : at) positions.push_back(static_cast<float>(c));
    return vertex_count() - 1;
}

rt_u32 TriangleMesh::add_vertex(const Vec& at, const Vec& normal, double u, double v) {
    for (const double c : normal) normals.push_back(static_cast<float>(c));
    for (const double c : {u, v}) uvs.push_back(static_cast<float>(c));
    return add_vertex(at);
}

void TriangleMesh::add_triangle(const Point& a, const Point& b, const Point& c) {
    const rt_u32 first = vertex_count();
    for (const Point& p : {a, b, c}) positions.insert(positions.end(), p.begin(), p.end());
    add_triangle(first, first + 1, first + 2);
}

void TriangleMesh::add_quad(const Vec& a, const Vec& b, const Vec& c, const Vec& d) {
    const rt_u32 first = add_vertex(a);
    add_vertex(b), add_vertex(c), add_vertex(d);
    add_triangle(first, first + 1, first + 2);
    add_triangle(first, first + 2, first + 3);
}

void TriangleMesh::add_quad(const Point& a, const Point& b, const Point& c, const Point& d) {
    add_quad(to_vec(a), to_vec(b), to_vec(c), to_vec(d));
}

void TriangleMesh::add_grid(const Grid& grid, const std::function<void(rt_u32 row, rt_u32 column)>& add) {
    const rt_u32 first = vertex_count(), height = grid.rows + !grid.rows_meet, width = grid.columns + !grid.columns_meet;
    for (rt_u32 row = 0; row < height; ++row)
        for (rt_u32 column = 0; column < width; ++column) add(row, column);
    for (rt_u32 row = 0; row < grid.rows; ++row)
        for (rt_u32 column = 0; column < grid.columns; ++column)
            for (const auto& [a, b, c] : grid.cut) {
                const auto in_row = [&](rt_u32 half) { return (a / 2 == half) + (b / 2 == half) + (c / 2 == half); };
                if (row == 0 && grid.first_is_point && in_row(0) > 1) continue;
                if (row + 1 == grid.rows && grid.last_is_point && in_row(1) > 1) continue;
                const auto at = [&](rt_u32 corner) {
                    return first + (row + corner / 2) % height * width + (column + corner % 2) % width;
                };
                add_triangle(at(a), at(b), at(c));
            }
}

void TriangleMesh::add_box(const Vec& lo, const Vec& hi) {
    const rt_u32 first = vertex_count();
    for (int i = 0; i < 8; ++i) add_vertex(i & 1 ? hi[0] : lo[0], i & 2 ? hi[1] : lo[1], i & 4 ? hi[2] : lo[2]);
    constexpr rt_u32 kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : kQuads) {
        add_triangle(first + q[0], first + q[1], first + q[2]);
        add_triangle(first + q[0], first + q[2], first + q[3]);
    }
}

void TriangleMesh::add_ball(const Point& center, float radius, int segments, int rings) {
    constexpr auto pi = static_cast<float>(kPi);
    const Grid grid{rt_u32(rings), rt_u32(segments), {{{0, 2, 1}, {2, 3, 1}}}, false, true, true, true};
    add_grid(grid, [&](rt_u32 r, rt_u32 s) {
        const float theta = pi * float(r) / float(rings), phi = 2 * pi * float(s) / float(segments);
        add_vertex(to_vec(Point{center[0] + radius * std::sin(theta) * std::sin(phi), center[1] + radius * std::cos(theta),
                                center[2] + radius * std::sin(theta) * std::cos(phi)}));
    });
}

void TriangleMesh::add(const TriangleMesh& other) {
    const rt_u32 first = vertex_count();
    positions.insert(positions.end(), other.positions.begin(), other.positions.end());
    normals.insert(normals.end(), other.normals.begin(), other.normals.end());
    uvs.insert(uvs.end(), other.uvs.begin(), other.uvs.end());
    for (const rt_u32 v : other.triangles) triangles.push_back(first + v);
}

void TriangleMesh::transform(double scale, const Vec& offset) {
    for (size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(scale * positions[i] + offset[i % 3]);
}

TriangleMesh uv_sphere(double radius, unsigned segments, unsigned rings) {
    TriangleMesh mesh;
    const rt_u32 top = mesh.add_vertex(0, radius, 0), bottom = mesh.add_vertex(0, -radius, 0);
    for (unsigned r = 1; r < rings; ++r)
        for (unsigned s = 0; s < segments; ++s) {
            const double theta = kPi * r / rings, phi = 2 * kPi * s / segments;
            mesh.add_vertex(radius * std::sin(theta) * std::sin(phi), radius * std::cos(theta),
                            radius * std::sin(theta) * std::cos(phi));
        }
    const auto at = [&](unsigned r, unsigned s) { return 2 + (r - 1) * segments + s % segments; };
    for (unsigned s = 0; s < segments; ++s) {
        mesh.add_triangle(top, at(1, s), at(1, s + 1));
        mesh.add_triangle(bottom, at(rings - 1, s + 1), at(rings - 1, s));
        for (unsigned r = 1; r + 1 < rings; ++r) {
            mesh.add_triangle(at(r, s), at(r + 1, s), at(r + 1, s + 1));
            mesh.add_triangle(at(r, s), at(r + 1, s + 1), at(r, s + 1));
        }
    }
    return mesh;
}

TriangleMesh torus(double major, double minor, unsigned segments, unsigned sides) {
    TriangleMesh mesh;
    mesh.add_grid({segments, sides, kCut023, true, true}, [&](rt_u32 s, rt_u32 k) {
        const double phi = 2 * kPi * s / segments, psi = 2 * kPi * k / sides, r = major + minor * std::cos(psi);
        mesh.add_vertex(r * std::sin(phi), minor * std::sin(psi), r * std::cos(phi));
    });
    return mesh;
}

TriangleMesh box(double half_size) {
    TriangleMesh mesh;
    mesh.add_box({-half_size, -half_size, -half_size}, {half_size, half_size, half_size});
    return mesh;
}

rt_u32 add_mesh(Scene& scene, TriangleMesh mesh, rt_u32 material, const std::string& name) {
    if (scene.materials.empty()) scene.materials.push_back({"default", default_material()});
    Mesh added;
    added.name = name;
    added.first_vertex = scene.vertex_count();
    added.first_triangle = scene.triangle_count();
    added.vertex_count = mesh.vertex_count();
    added.triangle_count = added.polygon_count = mesh.triangle_count();
    for (rt_u32& v : mesh.triangles) v += added.first_vertex;
    append(scene.positions, std::move(mesh.positions));
    append(scene.normals, std::move(mesh.normals));
    append(scene.uvs, std::move(mesh.uvs));
    append(scene.triangles, std::move(mesh.triangles));
    scene.triangle_materials.resize(scene.triangle_count(), material);
    scene.meshes.push_back(std::move(added));
    return static_cast<rt_u32>(scene.meshes.size() - 1);
}

Instance& place(Scene& scene, rt_u32 mesh, const Affine& world_from_object, rt_u32 material) {
    Instance& instance = scene.instances.emplace_back();
    instance.name = scene.meshes[mesh].name;
    instance.mesh = mesh;
    instance.world_from_object = world_from_object;
    instance.material = material;
    return instance;
}

}  // namespace clarity
