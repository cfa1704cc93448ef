#include "tools/bench/scenes/subdivide.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <unordered_map>
#include <vector>

#include "base/angle.hpp"
#include "base/parallel_for.hpp"
#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace clarity::bench {
namespace {

// World-space triangles. Points at the same position are one vertex, so that seams of texture coordinates do not tear open.
struct OneMesh {
    std::vector<Vec> points, normals;
    std::vector<std::array<rt_u32, 3>> triangles;
    std::vector<rt_u32> materials;
};

struct HashOfPoint {
    size_t operator()(const std::array<float, 3>& p) const {
        uint64_t hash = 0;
        for (const float x : p) {
            uint32_t bits;
            std::memcpy(&bits, &x, sizeof bits);
            hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 32;
        }
        return hash;
    }
};

OneMesh one_mesh(const Scene& scene) {
    OneMesh mesh;
    std::unordered_map<std::array<float, 3>, rt_u32, HashOfPoint> known;
    for (const Instance& instance : scene.instances) {
        const Mesh& from = scene.meshes[instance.mesh];
        for (rt_u32 i = from.first_triangle; i < from.first_triangle + from.triangle_count; ++i) {
            std::array<rt_u32, 3> corners{};
            for (int c = 0; c < 3; ++c) {
                auto p = transform_point(instance.world_from_object,
                                         &scene.positions[3 * size_t(scene.triangles[3 * size_t(i) + c])]);
                for (float& x : p) x += 0.0f;  // turns -0 into 0, which is the same position
                const auto [place, fresh] = known.try_emplace(p, static_cast<rt_u32>(mesh.points.size()));
                if (fresh) mesh.points.push_back({p[0], p[1], p[2]});
                corners[c] = place->second;
            }
            mesh.triangles.push_back(corners);
            mesh.materials.push_back(instance.material != RT_NONE ? instance.material : scene.triangle_materials[i]);
        }
    }
    // Vertex normals: sums of the triangles' normals, weighted by area.
    mesh.normals.assign(mesh.points.size(), Vec{0, 0, 0});
    for (const auto& t : mesh.triangles) {
        const Vec normal = cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
        for (const rt_u32 corner : t) mesh.normals[corner] += normal;
    }
    for (Vec& normal : mesh.normals) normal = normalized(normal, {0, 0, 0});
    return mesh;
}

// Height at a point: waves along three directions which are oblique to all axes. Each octave is twice as fine and half as high.
double roughness(const Vec& p, double size, double finest) {
    double sum = 0;
    for (double wave = size / 4; wave > 4 * finest; wave /= 2) {
        const double k = 2 * kPi / wave;
        sum += 0.015 * wave *
               (std::sin(k * dot(p, Vec{0.62, 0.51, 0.60})) * std::sin(k * dot(p, Vec{-0.55, 0.80, 0.24}) + 1) +
                std::sin(k * dot(p, Vec{0.33, -0.41, 0.85}) + 2));
    }
    return sum;
}

// Numbers the new points: first the old points, then n - 1 points along each edge, then the points inside each triangle. Of the
// triangles which share a point, the first one places it.
class Refined {
 public:
    Refined(const OneMesh& mesh, unsigned n) : mesh_(mesh), n_(n) {
        const size_t count = mesh.triangles.size();
        std::vector<uint64_t> keys(3 * count);
        for (size_t t = 0; t < count; ++t)
            for (int e = 0; e < 3; ++e) keys[3 * t + e] = key(t, e);
        std::vector<uint64_t> edges = keys;
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        edge_of_.resize(3 * count);
        parallel_for(static_cast<uint32_t>((count + kChunk - 1) / kChunk), [&](uint32_t c) {
            for (size_t i = 3 * kChunk * c; i < std::min(keys.size(), 3 * kChunk * (c + 1)); ++i)
                edge_of_[i] = static_cast<rt_u32>(std::lower_bound(edges.begin(), edges.end(), keys[i]) - edges.begin());
        });
        edge_owner_.resize(edges.size());
        point_owner_.resize(mesh.points.size());
        for (size_t t = count; t-- > 0;)
            for (int e = 0; e < 3; ++e) {
                edge_owner_[edge_of_[3 * t + e]] = static_cast<rt_u32>(t);
                point_owner_[mesh.triangles[t][e]] = static_cast<rt_u32>(t);
            }
        first_edge_ = mesh.points.size();
        first_inner_ = first_edge_ + edges.size() * (n - 1);
    }

    // True if the triangle places its corner c (owns_corner), or the points between corner c and the next corner (owns_edge).
    bool owns_corner(size_t triangle, int c) const { return point_owner_[mesh_.triangles[triangle][c]] == triangle; }
    bool owns_edge(size_t triangle, int c) const { return edge_owner_[edge_of_[3 * triangle + c]] == triangle; }

    size_t count() const { return first_inner_ + mesh_.triangles.size() * inner(); }

    // Index of the point which is i of n steps from corner a towards b and j steps towards c.
    size_t index(size_t triangle, unsigned i, unsigned j) const {
        const auto& t = mesh_.triangles[triangle];
        const unsigned k = n_ - i - j;
        if (k == n_) return t[0];
        if (i == n_) return t[1];
        if (j == n_) return t[2];
        if (j == 0) return on_edge(triangle, 0, i);
        if (k == 0) return on_edge(triangle, 1, j);
        if (i == 0) return on_edge(triangle, 2, k);
        // Rows j = 1 .. n - 2; row j has n - 1 - j points.
        const size_t row = size_t(j - 1) * (n_ - 1) - size_t(j - 1) * j / 2;
        return first_inner_ + triangle * inner() + row + (i - 1);
    }

 private:
    size_t inner() const { return size_t(n_ - 1) * (n_ - 2) / 2; }
    uint64_t key(size_t triangle, int e) const {
        const auto& t = mesh_.triangles[triangle];
        const auto [low, high] = std::minmax(t[e], t[(e + 1) % 3]);
        return uint64_t{low} << 32 | high;
    }
    // Index of the point which is s of n steps from corner e to the next corner.
    size_t on_edge(size_t triangle, int e, unsigned s) const {
        const auto& t = mesh_.triangles[triangle];
        const bool forward = t[e] < t[(e + 1) % 3];
        return first_edge_ + size_t(edge_of_[3 * triangle + e]) * (n_ - 1) + (forward ? s : n_ - s) - 1;
    }

    static constexpr size_t kChunk = 4096;
    const OneMesh& mesh_;
    const unsigned n_;
    std::vector<rt_u32> edge_of_;  // the three edges of each triangle
    std::vector<rt_u32> edge_owner_, point_owner_;
    size_t first_edge_ = 0, first_inner_ = 0;
};

// Position of a point, given by its weights in a triangle: curved, then displaced. Corners of weight 0 are skipped and the
// others are added in the order of their vertex indices, so that both triangles of an edge compute exactly the same point.
Vec place(const OneMesh& mesh, const std::array<rt_u32, 3>& t, const double weights[3], double size, double finest) {
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return t[a] < t[b]; });
    Vec flat{}, normal{};
    for (const int c : order) {
        if (weights[c] == 0) continue;
        flat += weights[c] * mesh.points[t[c]];
        normal += weights[c] * mesh.normals[t[c]];
    }
    Vec bulged{};
    for (const int c : order) {
        if (weights[c] == 0) continue;
        const double height = dot(flat - mesh.points[t[c]], mesh.normals[t[c]]);
        bulged += weights[c] * (flat - height * mesh.normals[t[c]]);
    }
    constexpr double kBulge = 0.75;  // curvature, 0 (flat) to 1: the paper's choice
    const Vec p = (1 - kBulge) * flat + kBulge * bulged;
    return p + roughness(p, size, finest) * normalized(normal, {0, 0, 0});
}

}  // namespace

Scene subdivide(const Scene& scene, unsigned n) {
    const OneMesh mesh = one_mesh(scene);
    const Refined refined(mesh, n);
    Scene out;
    out.spheres = scene.spheres;
    out.planes = scene.planes;
    out.polygons = scene.polygons;
    out.polygon_corners = scene.polygon_corners;
    out.materials = scene.materials;
    for (Material& material : out.materials) material.values.texture = RT_NONE;  // because texture coordinates are not kept
    out.lights = scene.lights;
    out.cameras = scene.cameras;
    out.background = scene.background;
    out.ambient = scene.ambient;
    const double size = scene.bounds().diagonal();
    const double finest = size / (std::sqrt(double(mesh.triangles.size())) * n);
    const size_t per_triangle = size_t(n) * n;
    std::vector<float>& positions = out.positions.own();
    std::vector<rt_u32>&triangles = out.triangles.own(), &triangle_materials = out.triangle_materials.own();
    positions.resize(3 * refined.count());
    triangles.resize(3 * mesh.triangles.size() * per_triangle);
    triangle_materials.resize(mesh.triangles.size() * per_triangle);
    const auto put = [&](size_t triangle, unsigned i, unsigned j) {
        const double weights[3] = {double(n - i - j) / n, double(i) / n, double(j) / n};
        const Vec p = place(mesh, mesh.triangles[triangle], weights, size, finest);
        for (int k = 0; k < 3; ++k) positions[3 * refined.index(triangle, i, j) + k] = static_cast<float>(p[k]);
    };
    parallel_for(static_cast<uint32_t>(mesh.triangles.size()), [&](uint32_t t) {
        const std::array<unsigned, 2> corners[] = {{0, 0}, {n, 0}, {0, n}};
        for (int c = 0; c < 3; ++c) {
            if (refined.owns_corner(t, c)) put(t, corners[c][0], corners[c][1]);
            if (!refined.owns_edge(t, c)) continue;
            for (unsigned s = 1; s < n; ++s) {
                if (c == 0) put(t, s, 0);
                if (c == 1) put(t, n - s, s);
                if (c == 2) put(t, 0, n - s);
            }
        }
        rt_u32* at = &triangles[3 * t * per_triangle];
        const auto corner = [&](unsigned i, unsigned j) { *at++ = static_cast<rt_u32>(refined.index(t, i, j)); };
        for (unsigned j = 0; j < n; ++j)
            for (unsigned i = 0; i + j < n; ++i) {
                if (i > 0 && j > 0) put(t, i, j);  // points inside the triangle
                corner(i, j), corner(i + 1, j), corner(i, j + 1);
                if (i + j + 1 < n) corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1);
            }
        std::fill_n(triangle_materials.begin() + t * per_triangle, per_triangle, mesh.materials[t]);
    });
    Mesh whole;
    whole.name = "subdivided";
    whole.vertex_count = out.vertex_count();
    whole.triangle_count = out.triangle_count();
    out.meshes.push_back(whole);
    Instance instance;
    instance.name = whole.name;
    out.instances.push_back(instance);
    return out;
}

}  // namespace clarity::bench
