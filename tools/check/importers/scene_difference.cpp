#include "tools/check/importers/scene_difference.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <map>

#include "base/numbers.hpp"
#include "import/wire.hpp"

namespace clarity::check {
namespace {

constexpr double kRoom = 1e-3;      // of sizes, areas and texture coordinates
constexpr double kSameWay = 0.999;  // cosine between two directions that are the same: 2.5 degrees
constexpr size_t kMostShown = 3;    // of what is there instead

std::string text_of(double x) {
    return exact_text(static_cast<float>(x));
}
std::string text_of(const Vec& v) {
    return text_of(v[0]) + " " + text_of(v[1]) + " " + text_of(v[2]);
}

// A corner of a triangle of the world.
struct WorldCorner {
    Vec at, normal, facing;  // normal: 0 where there is none
    double u, v;
    bool has_uv;
};

// Calls visit(corners, weight) for each triangle of the world. weight: -1 where the instance is a mirror image, whose triangles
// wind the other way round.
template <class Visit>
void for_each_triangle(const Scene& scene, const Visit& visit) {
    for (const Instance& instance : scene.instances) {
        if (!instance.visible) continue;
        const Mesh& mesh = scene.meshes[instance.mesh];
        const Affine& m = instance.world_from_object;
        Affine back{};
        if (!invert(m, back)) continue;
        const Vec x{m[0], m[4], m[8]}, y{m[1], m[5], m[9]}, z{m[2], m[6], m[10]};
        const double weight = dot(cross(x, y), z) < 0 ? -1 : 1;
        const auto turned = [&](const Vec& n) {  // as normals are: by the transposed inverse
            return Vec{back[0] * n[0] + back[4] * n[1] + back[8] * n[2], back[1] * n[0] + back[5] * n[1] + back[9] * n[2],
                       back[2] * n[0] + back[6] * n[1] + back[10] * n[2]};
        };
        for (size_t t = 0; t < mesh.triangle_count; ++t) {
            const rt_u32* const index = &scene.triangles[3 * (mesh.first_triangle + t)];
            WorldCorner corners[3];
            Vec at[3];
            for (size_t k = 0; k < 3; ++k) {
                const size_t v = index[k];
                const float* const p = &scene.positions[3 * v];
                at[k] = {p[0], p[1], p[2]};
                const auto placed = transform_point(m, p);
                corners[k].at = {placed[0], placed[1], placed[2]};
                corners[k].normal = {};
                if (!scene.normals.empty()) {
                    const float* const n = &scene.normals[3 * v];
                    corners[k].normal = turned({n[0], n[1], n[2]});
                }
                corners[k].has_uv = !scene.uvs.empty();
                corners[k].u = scene.uvs.empty() ? 0 : double(scene.uvs[2 * v]);
                corners[k].v = scene.uvs.empty() ? 0 : double(scene.uvs[2 * v + 1]);
            }
            for (WorldCorner& corner : corners) corner.facing = turned(cross(at[1] - at[0], at[2] - at[0]));
            visit(corners, weight);
        }
    }
}

bool same_way(const Vec& a, const Vec& b) {
    return dot(a, b) >= kSameWay * length(a) * length(b) && length(a) > 0 && length(b) > 0;
}

std::string text_of(const WorldCorner& corner, const Contents::Corner& asked) {
    std::string text;
    const auto add = [&](const std::string& more) { text += (text.empty() ? "" : ", ") + more; };
    const auto direction = [](const Vec& v) { return length(v) > 0 ? text_of(normalized(v)) : std::string("none"); };
    if (asked.normal) add("the normal " + direction(corner.normal));
    if (asked.facing) add("a triangle that faces " + direction(corner.facing));
    if (asked.uv) add(corner.has_uv ? "uv " + text_of(corner.u) + " " + text_of(corner.v) : "no uv");
    return text.empty() ? "a corner" : text;
}

bool has_all(const WorldCorner& corner, const Contents::Corner& asked) {
    if (asked.normal && !same_way(corner.normal, *asked.normal)) return false;
    if (asked.facing && !same_way(corner.facing, *asked.facing)) return false;
    return !asked.uv ||
           (corner.has_uv && std::fabs(corner.u - (*asked.uv)[0]) <= kRoom && std::fabs(corner.v - (*asked.uv)[1]) <= kRoom);
}

std::string difference_of_corners(const Scene& scene, const Contents& truth) {
    const double room = kRoom * double(scene.bounds().diagonal());
    std::vector<std::vector<std::string>> there(truth.corners.size());
    std::vector<uint8_t> found(truth.corners.size(), 0);
    const Vec origin{scene.origin[0], scene.origin[1], scene.origin[2]};
    for_each_triangle(scene, [&](const WorldCorner(&corners)[3], double) {
        for (const WorldCorner& corner : corners)
            for (size_t i = 0; i < truth.corners.size(); ++i) {
                if (found[i] || length(corner.at - (truth.corners[i].at - origin)) > room) continue;
                if (has_all(corner, truth.corners[i])) {
                    found[i] = 1;
                    continue;
                }
                const std::string text = text_of(corner, truth.corners[i]);
                if (there[i].size() < kMostShown && std::find(there[i].begin(), there[i].end(), text) == there[i].end())
                    there[i].push_back(text);
            }
    });
    for (size_t i = 0; i < truth.corners.size(); ++i) {
        if (found[i]) continue;
        const Contents::Corner& asked = truth.corners[i];
        if (there[i].empty()) return "has no corner of a triangle at " + text_of(asked.at);
        WorldCorner wanted{};
        if (asked.normal) wanted.normal = *asked.normal;
        if (asked.facing) wanted.facing = *asked.facing;
        if (asked.uv) wanted.u = (*asked.uv)[0], wanted.v = (*asked.uv)[1], wanted.has_uv = true;
        std::string text = "has at " + text_of(asked.at);
        for (size_t k = 0; k < there[i].size(); ++k) text += (k ? "; " : " ") + there[i][k];
        return text + "; but there should be " + text_of(wanted, asked);
    }
    return {};
}

std::string difference_of_volume(const Scene& scene, double expected) {
    const Bounds bounds = scene.bounds();
    Vec middle;
    for (size_t k = 0; k < 3; ++k) middle[k] = 0.5 * (double(bounds.min[k]) + double(bounds.max[k]));
    double volume = 0;
    for_each_triangle(scene, [&](const WorldCorner(&corners)[3], double weight) {
        volume += weight * dot(corners[0].at - middle, cross(corners[1].at - middle, corners[2].at - middle)) / 6;
    });
    if (std::fabs(volume - expected) <= kRoom * std::fabs(expected)) return {};
    const bool turned = std::fabs(volume + expected) <= kRoom * std::fabs(expected);
    return "encloses a volume of " + text_of(volume) + ", not " + text_of(expected) +
           (turned ? ": its triangles wind the other way round" : "");
}

// Whether a box is as expected; then nothing, else what it is. off: of the scene's origin.
std::string difference_of_box(const Bounds& bounds, const std::array<double, 3>& off, const std::array<Vec, 2>& expected) {
    const auto& [lo, hi] = expected;
    double size = 0;
    for (size_t k = 0; k < 3; ++k) size = std::max(size, hi[k] - lo[k]);
    for (size_t k = 0; k < 3; ++k) {
        const double least = bounds.min[k] + off[k], most = bounds.max[k] + off[k];
        if (!(std::fabs(least - lo[k]) <= kRoom * size && std::fabs(most - hi[k]) <= kRoom * size))
            return std::string("goes from ") + text_of(least) + " to " + text_of(most) + " along " + "xyz"[k] + ", not from " +
                   exact_text(lo[k]) + " to " + exact_text(hi[k]);
    }
    return {};
}

std::string difference_of_materials(const Scene& scene, const Contents& truth) {
    std::map<std::string, double> there;
    for (const Instance& instance : scene.instances) {
        if (!instance.visible) continue;
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (size_t t = 0; t < mesh.triangle_count; ++t) {
            const rt_u32 own = scene.triangle_materials[mesh.first_triangle + t];
            ++there[scene.materials[instance.material == RT_NONE ? own : instance.material].name];
        }
    }
    for (const auto& [name, count] : truth.material_triangles)
        if (there[name] != count) {
            std::string all;
            for (const auto& [other, n] : there)
                if (n > 0) all += (all.empty() ? "" : ", ") + exact_text(n) + " of '" + other + "'";
            return "has " + exact_text(there[name]) + " triangles of the material '" + name + "', not " + exact_text(count) +
                   ": there are " + all;
        }
    return {};
}

std::string difference_of_instances(const Scene& scene, const Contents& truth) {
    for (const Contents::Placed& wanted : truth.placed) {
        std::string why = "has no instance with the name '" + wanted.name + "'";
        for (size_t i = 0; i < std::min(scene.instances.size(), kMostShown); ++i)
            why += (i ? ", '" : ": its first ones are '") + scene.instances[i].name + "'";
        for (const Instance& instance : scene.instances) {
            if (instance.name != wanted.name) continue;
            const Mesh& mesh = scene.meshes[instance.mesh];
            if (wanted.triangles && mesh.triangle_count != *wanted.triangles) {
                why = "has an instance '" + wanted.name + "' of " + std::to_string(mesh.triangle_count) + " triangles, not " +
                      exact_text(*wanted.triangles);
                continue;
            }
            Bounds box;
            for (size_t i = 0; i < 3 * size_t(mesh.triangle_count); ++i)
                box.add(transform_point(instance.world_from_object,
                                        &scene.positions[3 * size_t(scene.triangles[3 * mesh.first_triangle + i])])
                            .data());
            why = wanted.bounds ? difference_of_box(box, scene.origin, *wanted.bounds) : "";
            if (why.empty()) break;
            why = "has an instance '" + wanted.name + "' that " + why;
        }
        if (!why.empty()) return why;
    }
    return {};
}

std::string name_of_vertex(const Scene& scene, size_t vertex) {
    for (size_t i = 0; i < scene.meshes.size(); ++i) {
        const Mesh& mesh = scene.meshes[i];
        if (vertex - mesh.first_vertex < mesh.vertex_count)
            return "vertex " + std::to_string(vertex - mesh.first_vertex) + " of mesh " + std::to_string(i) +
                   (mesh.name.empty() ? "" : " (" + mesh.name + ")");
    }
    return "vertex " + std::to_string(vertex);
}

// The first element that differs in any bit, or the size of the shorter array; SIZE_MAX: none.
template <class Array>
size_t first_difference(const Array& a, const Array& b) {
    const size_t count = std::min(a.size(), b.size());
    for (size_t i = 0; i < count; ++i)
        if (std::memcmp(&a[i], &b[i], sizeof a[i]) != 0) return i;
    return a.size() == b.size() ? SIZE_MAX : count;
}

}  // namespace

std::string difference(const Scene& scene, const Contents& truth) {
    const auto count = [&](const char* what, double there, const std::optional<double>& expected) {
        return !expected || there == *expected ? std::string()
                                               : "has " + exact_text(there) + " " + what + ", not " + exact_text(*expected);
    };
    std::string why = count("triangles", static_cast<double>(scene.placed_triangle_count()), truth.triangles);
    if (why.empty()) why = count("instances", static_cast<double>(scene.instances.size()), truth.instances);
    // The first one is the host's.
    if (why.empty()) why = count("materials", static_cast<double>(scene.materials.size() - 1), truth.materials);
    if (!why.empty()) return why;
    const double area = scene.surface_area();
    if (truth.area && !(std::fabs(area - *truth.area) <= kRoom * *truth.area))
        return "has a surface of " + exact_text(area) + ", not " + exact_text(*truth.area);
    if (truth.bounds) why = difference_of_box(scene.bounds(), scene.origin, *truth.bounds);
    if (why.empty()) why = difference_of_materials(scene, truth);
    if (why.empty()) why = difference_of_instances(scene, truth);
    if (why.empty() && truth.volume) why = difference_of_volume(scene, *truth.volume);
    return why.empty() ? difference_of_corners(scene, truth) : why;
}

std::string difference(const Scene& a, const Scene& b) {
    const auto counts = [](const char* what, size_t x, size_t y) {
        return x == y ? std::string() : std::to_string(x) + " and " + std::to_string(y) + " " + what;
    };
    for (const std::string& why :
         {counts("vertices", a.vertex_count(), b.vertex_count()), counts("triangles", a.triangle_count(), b.triangle_count()),
          counts("meshes", a.meshes.size(), b.meshes.size()), counts("instances", a.instances.size(), b.instances.size()),
          counts("materials", a.materials.size(), b.materials.size()), counts("lights", a.lights.size(), b.lights.size()),
          counts("cameras", a.cameras.size(), b.cameras.size())})
        if (!why.empty()) return why;
    const auto numbers = [&](const char* what, size_t per_vertex, const SharedArray<float>& x, const SharedArray<float>& y) {
        const size_t at = first_difference(x, y);
        if (at == SIZE_MAX) return std::string();
        std::string text = std::string(what) + " of " + name_of_vertex(a, at / per_vertex);
        if (at < std::min(x.size(), y.size())) text += " is " + exact_text(x[at]) + " and " + exact_text(y[at]);
        return text;
    };
    std::string why = numbers("a coordinate", 3, a.positions, b.positions);
    if (why.empty()) why = numbers("the normal", 3, a.normals, b.normals);
    if (why.empty()) why = numbers("a texture coordinate", 2, a.uvs, b.uvs);
    if (why.empty()) why = numbers("the colour", 4, a.colors, b.colors);
    if (!why.empty()) return why;
    if (const size_t at = first_difference(a.triangles, b.triangles); at != SIZE_MAX)
        return "the indices of triangle " + std::to_string(at / 3);
    if (const size_t at = first_difference(a.triangle_materials, b.triangle_materials); at != SIZE_MAX)
        return "the material of triangle " + std::to_string(at);
    for (size_t i = 0; i < a.instances.size(); ++i)
        if (a.instances[i].world_from_object != b.instances[i].world_from_object ||
            a.instances[i].mesh != b.instances[i].mesh || a.instances[i].material != b.instances[i].material)
            return "transform, mesh or material of instance " + std::to_string(i);
    for (size_t i = 0; i < a.materials.size(); ++i)
        if (std::memcmp(&a.materials[i].values, &b.materials[i].values, sizeof a.materials[i].values) != 0)
            return "a value of material " + std::to_string(i);
    if (import::scene_digest(a) != import::scene_digest(b)) return "lights, cameras, shapes, textures or motion";
    return {};
}

}  // namespace clarity::check
