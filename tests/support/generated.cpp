#include "support/generated.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace clarity::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

rt_u32 TriangleMesh::add_vertex(double x, double y, double z) {
    for (const double c : {x, y, z}) positions.push_back(static_cast<float>(c));
    return static_cast<rt_u32>(positions.size() / 3 - 1);
}

void TriangleMesh::add_triangle(rt_u32 a, rt_u32 b, rt_u32 c) {
    for (const rt_u32 v : {a, b, c}) triangles.push_back(v);
}

void TriangleMesh::add(const TriangleMesh& other) {
    const auto first = static_cast<rt_u32>(positions.size() / 3);
    positions.insert(positions.end(), other.positions.begin(), other.positions.end());
    for (const rt_u32 v : other.triangles) triangles.push_back(first + v);
}

void TriangleMesh::transform(double scale, const std::array<double, 3>& offset) {
    for (size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(scale * positions[i] + offset[i % 3]);
}

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
    for (unsigned s = 0; s < segments; ++s)
        for (unsigned k = 0; k < sides; ++k) {
            const double phi = 2 * kPi * s / segments, psi = 2 * kPi * k / sides, r = major + minor * std::cos(psi);
            mesh.add_vertex(r * std::sin(phi), minor * std::sin(psi), r * std::cos(phi));
        }
    const auto at = [&](unsigned s, unsigned k) { return (s % segments) * sides + k % sides; };
    for (unsigned s = 0; s < segments; ++s)
        for (unsigned k = 0; k < sides; ++k) {
            mesh.add_triangle(at(s, k), at(s + 1, k), at(s + 1, k + 1));
            mesh.add_triangle(at(s, k), at(s + 1, k + 1), at(s, k + 1));
        }
    return mesh;
}

TriangleMesh box(double half_size) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.add_vertex(i & 1 ? half_size : -half_size, i & 2 ? half_size : -half_size, i & 4 ? half_size : -half_size);
    constexpr rt_u32 kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : kQuads) {
        mesh.add_triangle(q[0], q[1], q[2]);
        mesh.add_triangle(q[0], q[2], q[3]);
    }
    return mesh;
}

Scene scene_of(const TriangleMesh& mesh) {
    Scene scene;
    scene.materials.push_back({"default", default_material()});
    scene.positions = mesh.positions;
    scene.triangles = mesh.triangles;
    scene.triangle_materials.assign(mesh.triangles.size() / 3, 0);
    Mesh m;
    m.vertex_count = scene.vertex_count();
    m.triangle_count = m.polygon_count = scene.triangle_count();
    if (m.triangle_count) {
        scene.meshes.push_back(m);
        scene.instances.emplace_back();
    }
    return scene;
}

ScenePtr shared_scene(Scene scene) {
    return std::make_shared<const Scene>(std::move(scene));
}

rt_u32 add_material(Scene& scene, const rt_material& values) {
    scene.materials.push_back({"", values});
    return static_cast<rt_u32>(scene.materials.size() - 1);
}

rt_material diffuse(float r, float g, float b) {
    rt_material m{};
    m.color[0] = r;
    m.color[1] = g;
    m.color[2] = b;
    m.shininess = 1;
    m.ior = 1;
    m.texture = RT_NONE;
    return m;
}

rt_material mirror(float reflect) {
    rt_material m = diffuse(0, 0, 0);
    m.reflect = reflect;
    return m;
}

rt_material glass(float ior) {
    rt_material m = diffuse(1, 1, 1);
    m.refract = 1;
    m.ior = ior;
    return m;
}

View view_from(const Point& eye, const Point& target, double fov_deg) {
    View view;
    view.camera.eye = eye;
    view.camera.target = target;
    view.camera.fov_y_rad = static_cast<float>(fov_deg * kPi / 180);
    return view;
}

View dark_view(const Point& eye, const Point& target, double fov_deg) {
    View view = view_from(eye, target, fov_deg);
    view.background = view.ambient = {0, 0, 0};
    return view;
}

ScenePtr rubble() {
    static const ScenePtr scene = [] {
        std::mt19937 random(11);
        std::uniform_real_distribution<double> at(-1, 1), decade(-4, 0);
        TriangleMesh mesh;
        for (int i = 0; i < 3000; ++i) {
            double corner[3][3];
            const double size = std::pow(10.0, decade(random));
            const double center[3] = {at(random), at(random), at(random)};
            for (auto& c : corner)
                for (int k = 0; k < 3; ++k) c[k] = center[k] + size * at(random);
            if (i % 7 == 0) std::copy_n(corner[0], 3, corner[1]);
            if (i % 11 == 0)
                for (int k = 0; k < 3; ++k) corner[2][k] = corner[0][k] + 1e-6 * at(random);
            if (i % 5 == 0)
                corner[0][i % 3] = corner[1][i % 3] = corner[2][i % 3] = 0.25;  // in a plane perpendicular to an axis
            for (int copies = i % 13 == 0 ? 6 : 1; copies > 0; --copies) {
                rt_u32 v[3];
                for (int c = 0; c < 3; ++c) v[c] = mesh.add_vertex(corner[c][0], corner[c][1], corner[c][2]);
                mesh.add_triangle(v[0], v[1], v[2]);
            }
        }
        return shared_scene(scene_of(mesh));
    }();
    return scene;
}

}  // namespace clarity::test
