// scene_maker.hpp -- makes scenes for checks: triangles, boxes and balls in meshes, and where these are placed.
#pragma once
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tools/check/scenes.hpp"
#include "tools/check/seed.hpp"

namespace clarity::check {

// Adds meshes, and places them, in a scene.
class Maker {
 public:
    explicit Maker(uint64_t seed = 0) : random_(random_of(17, seed)) {
        scene.materials.push_back({"default", default_material()});
    }

    void triangle(const Point& a, const Point& b, const Point& c) {
        for (const Point& p : {a, b, c}) {
            scene.triangles.push_back(static_cast<rt_u32>(scene.positions.size() / 3));
            scene.positions.append(p.begin(), p.end());
        }
        scene.triangle_materials.push_back(0);
    }
    void quad(const Point& a, const Point& b, const Point& c, const Point& d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }
    void box(const Point& lo, const Point& hi) {
        const auto at = [&](int i) { return Point{i & 1 ? hi[0] : lo[0], i & 2 ? hi[1] : lo[1], i & 4 ? hi[2] : lo[2]}; };
        constexpr int kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
        for (const auto& q : kQuads) quad(at(q[0]), at(q[1]), at(q[2]), at(q[3]));
    }
    static constexpr float kPi = 3.14159265f;
    void ball(const Point& center, float radius, int segments, int rings) {
        const auto at = [&](int r, int s) {
            const float theta = kPi * float(r) / float(rings), phi = 2 * kPi * float(s % segments) / float(segments);
            return Point{center[0] + radius * std::sin(theta) * std::sin(phi), center[1] + radius * std::cos(theta),
                         center[2] + radius * std::sin(theta) * std::cos(phi)};
        };
        for (int r = 0; r < rings; ++r)
            for (int s = 0; s < segments; ++s) {
                if (r > 0) triangle(at(r, s), at(r + 1, s), at(r, s + 1));
                if (r + 1 < rings) triangle(at(r + 1, s), at(r + 1, s + 1), at(r, s + 1));
            }
    }
    void soup(const Point& center, float spread, float size, unsigned count) {
        for (unsigned i = 0; i < count; ++i) {
            const Point p = around(center, spread);
            const float s = size * (0.1f + random() * random());
            triangle(p, around(p, s), around(p, s));
        }
    }
    float random() { return std::uniform_real_distribution<float>(0, 1)(random_); }
    Point around(const Point& center, float spread) {
        Point p = center;
        for (float& c : p) c += spread * (2 * random() - 1);
        return p;
    }

    // Ends the mesh of the triangles since the last call. Returns its number.
    rt_u32 mesh() {
        Mesh mesh;
        mesh.first_vertex = vertices_;
        mesh.first_triangle = triangles_;
        vertices_ = static_cast<rt_u32>(scene.positions.size() / 3);
        triangles_ = static_cast<rt_u32>(scene.triangles.size() / 3);
        mesh.vertex_count = vertices_ - mesh.first_vertex;
        mesh.triangle_count = mesh.polygon_count = triangles_ - mesh.first_triangle;
        scene.meshes.push_back(mesh);
        return static_cast<rt_u32>(scene.meshes.size() - 1);
    }
    void place(rt_u32 mesh, const Affine& world_from_object = kIdentity) {
        Instance instance;
        instance.mesh = mesh;
        instance.world_from_object = world_from_object;
        scene.instances.push_back(instance);
    }
    void sphere(const Point& center, float radius) { scene.spheres.push_back({center, radius, 0}); }
    void polygon(const std::vector<Point>& corners) {
        Polygon polygon;
        polygon.first_corner = static_cast<rt_u32>(scene.polygon_corners.size() / 3);
        polygon.corner_count = static_cast<rt_u32>(corners.size());
        scene.polygons.push_back(polygon);
        for (const Point& p : corners) scene.polygon_corners.insert(scene.polygon_corners.end(), p.begin(), p.end());
    }

    Scene scene;

 private:
    std::mt19937 random_;
    rt_u32 vertices_ = 0, triangles_ = 0;
};

// A turn about a slanted axis, with a scale for each axis and a translation.
inline Affine placed(const Point& at, float angle, const Point& scale) {
    const float c = std::cos(angle), s = std::sin(angle), x = 0.48f, y = 0.6f, z = 0.64f, k = 1 - c;
    const float turn[9] = {c + k * x * x,     k * x * y - s * z, k * x * z + s * y, k * x * y + s * z, c + k * y * y,
                           k * y * z - s * x, k * x * z - s * y, k * y * z + s * x, c + k * z * z};
    Affine m{};
    for (int r = 0; r < 3; ++r) {
        for (int j = 0; j < 3; ++j) m[4 * r + j] = turn[3 * r + j] * scale[j];
        m[4 * r + 3] = at[r];
    }
    return m;
}

// Shells around the origin of sizes from 8 down to 1e-7: a tree that is deeper than any other of the checks' scenes, in a group
// of its own.
inline Instance& place_shells(Maker& make, const Affine& world_from_object) {
    for (int i = 0; i < 100; ++i) {
        const float s = 8 * std::pow(1.2f, -float(i));
        make.box({-s, -s, -s}, {s, s, s});
    }
    make.place(make.mesh(), world_from_object);
    make.scene.instances.back().apart = true;
    return make.scene.instances.back();
}

// What other scenes hold so that their programs are those of the mixed scene: a sphere, a polygon, and the shells, because
// structures define the size of their stack by the deepest tree. No ray sees these shells; hits.nested sees those of the mixed
// scene. All lie within 1e-4 of the point `at`, in its plane across y, and rays are not aimed there.
inline void add_common_part(Maker& make, const Point& at) {
    place_shells(make, placed(at, 0, {1e-7f, 1e-7f, 1e-7f})).visible = false;
    make.sphere(at, 1e-7f);
    make.polygon({at, {at[0] + 1e-4f, at[1], at[2]}, {at[0], at[1], at[2] + 1e-4f}});
}

}  // namespace clarity::check
