#include "scene/tangents.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "scene/vec.hpp"

namespace clarity {
namespace {

constexpr double kOne = 16383;  // of the stored components

struct Frame {
    explicit Frame(const Scene& scene, rt_u32 triangle) {
        const rt_u32* const v = scene.triangles.data() + 3 * size_t(triangle);
        for (int c = 0; c < 3; ++c) corner[c] = to_vec(&scene.positions[3 * size_t(v[c])]);
        const Vec e = corner[1] - corner[0];
        const Vec n = cross(e, corner[2] - corner[0]);
        is_flat = !(length(e) > 0) || !(length(n) > 0);
        if (is_flat) return;
        along = normalized(e);
        normal = normalized(n);
        across = cross(normal, along);
        for (int c = 0; c < 3; ++c) {
            normals[c] = normal;
            if (scene.normals.empty()) continue;
            const Vec own = to_vec(&scene.normals[3 * size_t(v[c])]);
            if (length(own) > 1e-6) normals[c] = normalized(own);
        }
    }
    // The word of a tangent at a corner; 0 if it has no direction in the plane.
    rt_u32 word(int c, const Vec& tangent) const {
        const double facing = dot(normals[c], normal);
        Vec flat = tangent - (dot(tangent, normal) / (std::fabs(facing) > 0.05 ? facing : 1)) * normals[c];
        flat = flat - dot(flat, normal) * normal;
        const double size = length(flat);
        if (!(size > 0)) return 0;
        const auto part = [&](const Vec& axis) {
            return static_cast<uint32_t>(static_cast<int32_t>(std::lround(kOne * dot(flat, axis) / size))) & 0x7fffu;
        };
        return part(along) << 1 | part(across) << 17;
    }
    Vec corner[3], normals[3], along{}, across{}, normal{};
    bool is_flat = true;
};

void store(const Frame& frame, const Vec (&tangents)[3], bool is_mirrored, rt_u32* words) {
    rt_u32 made[3];
    for (int c = 0; c < 3; ++c)
        if ((made[c] = frame.word(c, tangents[c])) == 0) return;
    made[0] |= is_mirrored ? 1 : 0;
    std::copy_n(made, 3, words);
}

// Corners with the same key have the same tangent.
struct CornerKey {
    std::array<float, 8> values{};  // position, normal, coordinates
    bool is_mirrored = false;
    bool operator==(const CornerKey& b) const {
        return is_mirrored == b.is_mirrored && std::memcmp(values.data(), b.values.data(), sizeof values) == 0;
    }
};
struct CornerHash {
    size_t operator()(const CornerKey& key) const {
        uint64_t hash = key.is_mirrored ? 1 : 2;
        for (const float x : key.values) {
            uint32_t bits;
            std::memcpy(&bits, &x, sizeof bits);
            hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 29;
        }
        return hash;
    }
};

// Uses of textures that need tangents: their texels are directions.
constexpr rt_u32 kDirections[] = {RT_MAP_NORMAL, RT_MAP_CLEARCOAT_NORMAL, RT_MAP_ANISOTROPY};

// The set of coordinates that a material's tangents follow; RT_NONE: it needs none.
rt_u32 set_of(const Scene& scene, rt_u32 material) {
    for (const rt_u32 use : kDirections)
        if (const rt_u32 map = scene.materials[material].maps[use]; map != RT_NONE) return scene.maps[map].set;
    const MaterialValues& values = scene.materials[material].values;
    return values.model == RT_MODEL_GLTF && values.layers.anisotropy > 0 ? 0 : RT_NONE;
}

class Maker {
 public:
    Maker(Scene& scene, const Mesh& mesh, rt_u32 set) : scene_(scene), mesh_(mesh), uvs_(set == 0 ? scene.uvs : scene.uvs2) {}

    // wanted: the triangles of the mesh that take part.
    void make(const std::vector<bool>& wanted) {
        if (uvs_.empty()) return;
        std::unordered_map<CornerKey, Vec, CornerHash> sums;
        each(wanted, [&](const Frame& frame, rt_u32 triangle, bool is_mirrored, const Vec& along_u) {
            for (int c = 0; c < 3; ++c) {
                const Vec& n = frame.normals[c];
                const auto flat = [&](const Vec& d) { return d - dot(d, n) * n; };
                const Vec tangent = flat(along_u), to = flat(frame.corner[(c + 1) % 3] - frame.corner[c]),
                          from = flat(frame.corner[(c + 2) % 3] - frame.corner[c]);
                const double size = length(tangent), sides = length(to) * length(from);
                if (!(size > 0) || !(sides > 0)) continue;
                const double angle = std::acos(std::clamp(dot(to, from) / sides, -1.0, 1.0));
                Vec& sum = sums[key(frame, triangle, c, is_mirrored)];
                sum = sum + (angle / size) * tangent;
            }
        });
        each(wanted, [&](const Frame& frame, rt_u32 triangle, bool is_mirrored, const Vec&) {
            Vec tangents[3];
            for (int c = 0; c < 3; ++c) tangents[c] = sums[key(frame, triangle, c, is_mirrored)];
            store(frame, tangents, is_mirrored, &scene_.tangents.own()[3 * size_t(triangle)]);
        });
    }

 private:
    template <class Body>
    void each(const std::vector<bool>& wanted, const Body& body) {
        for (rt_u32 i = 0; i < mesh_.triangle_count; ++i) {
            if (!wanted[i]) continue;
            const rt_u32 triangle = mesh_.first_triangle + i;
            const Frame frame(scene_, triangle);
            double u[3], v[3];
            for (int c = 0; c < 3; ++c) {
                const size_t vertex = scene_.triangles[3 * size_t(triangle) + c];
                u[c] = uvs_[2 * vertex], v[c] = uvs_[2 * vertex + 1];
            }
            const double area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]);
            if (frame.is_flat || area == 0 || !std::isfinite(area)) continue;
            const Vec along_u = (area < 0 ? -1.0 : 1.0) * ((v[2] - v[0]) * (frame.corner[1] - frame.corner[0]) -
                                                           (v[1] - v[0]) * (frame.corner[2] - frame.corner[0]));
            body(frame, triangle, area < 0, along_u);
        }
    }
    CornerKey key(const Frame& frame, rt_u32 triangle, int c, bool is_mirrored) const {
        const size_t vertex = scene_.triangles[3 * size_t(triangle) + c];
        CornerKey key;
        key.is_mirrored = is_mirrored;
        for (int k = 0; k < 3; ++k) {
            key.values[k] = scene_.positions[3 * vertex + k] + 0.0f;  // -0 becomes 0
            key.values[3 + k] = static_cast<float>(frame.normals[c][k]) + 0.0f;
        }
        for (int k = 0; k < 2; ++k) key.values[6 + k] = uvs_[2 * vertex + k] + 0.0f;
        return key;
    }

    Scene& scene_;
    const Mesh mesh_;
    const SharedArray<float>& uvs_;
};

}  // namespace

void store_tangents(Scene& scene, rt_u32 triangle, const std::vector<float>& tangents, rt_u32 first_vertex) {
    const Frame frame(scene, triangle);
    if (frame.is_flat) return;
    Vec directions[3];
    double handed = 0;
    for (int c = 0; c < 3; ++c) {
        const float* const t = &tangents[4 * size_t(scene.triangles[3 * size_t(triangle) + c] - first_vertex)];
        directions[c] = to_vec(t);
        if (!(length(directions[c]) > 1e-6) || !std::isfinite(length(directions[c]))) return;
        // The triangle's own side decides about the side of the normal, and so about the bitangent.
        handed += (t[3] < 0 ? -1 : 1) * (dot(frame.normals[c], frame.normal) < 0 ? -1 : 1);
    }
    store(frame, directions, handed < 0, &scene.tangents.own()[3 * size_t(triangle)]);
}

void make_tangents(Scene& scene) {
    std::vector<rt_u32> sets;
    for (size_t m = 0; m < scene.materials.size(); ++m) sets.push_back(set_of(scene, static_cast<rt_u32>(m)));
    if (std::all_of(sets.begin(), sets.end(), [](rt_u32 set) { return set == RT_NONE; })) {
        scene.tangents = {};
        return;
    }
    scene.tangents.resize(scene.triangles.size(), 0);
    std::vector<rt_u32> of_instances(scene.meshes.size(), RT_NONE);
    for (const Instance& instance : scene.instances)
        if (instance.material != RT_NONE && sets[instance.material] != RT_NONE)
            for (const rt_u32 mesh : {instance.mesh, instance.moving_mesh}) of_instances[mesh] = sets[instance.material];
    for (size_t m = 0; m < scene.meshes.size(); ++m) {
        const Mesh& mesh = scene.meshes[m];
        std::vector<bool> wanted[2] = {std::vector<bool>(mesh.triangle_count), std::vector<bool>(mesh.triangle_count)};
        bool any[2] = {false, false};
        for (rt_u32 i = 0; i < mesh.triangle_count; ++i) {
            const size_t triangle = size_t(mesh.first_triangle) + i;
            const rt_u32 own = sets[scene.triangle_materials[triangle]], set = own != RT_NONE ? own : of_instances[m];
            const rt_u32* const words = &scene.tangents[3 * triangle];
            if (set == RT_NONE || words[0] != 0 || words[1] != 0 || words[2] != 0) continue;
            wanted[set][i] = any[set] = true;
        }
        for (const rt_u32 set : {0u, 1u})
            if (any[set]) Maker(scene, mesh, set).make(wanted[set]);
    }
}

}  // namespace clarity
