// scene.cpp -- bounds and areas of a scene, and the default material.
#include "scene/scene.hpp"
#include "base/angle.hpp"

#include <algorithm>
#include <cmath>

#include "scene/vec.hpp"

namespace clarity {
namespace {

Vec linear(const Affine& m, const Vec& v) {
    return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[4] * v[0] + m[5] * v[1] + m[6] * v[2],
            m[8] * v[0] + m[9] * v[1] + m[10] * v[2]};
}

// The factor by which a map scales all lengths; negative if it does not scale uniformly.
double uniform_scale(const Affine& m) {
    const Vec x = {m[0], m[4], m[8]}, y = {m[1], m[5], m[9]}, z = {m[2], m[6], m[10]};
    const double s = dot(x, x), tolerance = 1e-6 * s;
    const bool uniform = std::abs(dot(y, y) - s) <= tolerance && std::abs(dot(z, z) - s) <= tolerance &&
                         std::abs(dot(x, y)) <= tolerance && std::abs(dot(y, z)) <= tolerance &&
                         std::abs(dot(z, x)) <= tolerance;
    return uniform ? std::sqrt(s) : -1;
}

// Sum of the areas of a mesh's triangles after the linear part of a map.
double mesh_area(const Scene& scene, const Mesh& mesh, const Affine& m) {
    double sum = 0;
    for (rt_u32 t = mesh.first_triangle; t < mesh.first_triangle + mesh.triangle_count; ++t) {
        const rt_u32* v = &scene.triangles[3 * size_t(t)];
        const Vec a = to_vec(&scene.positions[3 * size_t(v[0])]);
        const Vec b = to_vec(&scene.positions[3 * size_t(v[1])]), c = to_vec(&scene.positions[3 * size_t(v[2])]);
        sum += 0.5 * length(cross(linear(m, b - a), linear(m, c - a)));
    }
    return sum;
}

// Indices of the vertices that a mesh's triangles use, each once. Files may contain unused vertices, which must not enlarge the
// bounds.
std::vector<rt_u32> used_vertices(const Scene& scene, const Mesh& mesh) {
    std::vector<bool> used(mesh.vertex_count, false);
    const size_t first = 3 * size_t(mesh.first_triangle);
    for (size_t i = first; i < first + 3 * size_t(mesh.triangle_count); ++i)
        used[scene.triangles[i] - mesh.first_vertex] = true;
    std::vector<rt_u32> vertices;
    for (rt_u32 v = 0; v < mesh.vertex_count; ++v) {
        if (used[v]) vertices.push_back(mesh.first_vertex + v);
    }
    return vertices;
}

}  // namespace

rt_texture smaller_picture(const rt_texture& picture) {
    rt_texture next = picture;
    next.first += picture.width * picture.height;
    next.width = std::max(picture.width / 2, rt_u32(1));
    next.height = std::max(picture.height / 2, rt_u32(1));
    return next;
}

void Bounds::add(const float* p) {
    for (int i = 0; i < 3; ++i) {
        min[i] = empty ? p[i] : std::min(min[i], p[i]);
        max[i] = empty ? p[i] : std::max(max[i], p[i]);
    }
    empty = false;
}

float Bounds::diagonal() const {
    return empty ? 0.f : static_cast<float>(length(to_vec(max) - to_vec(min)));
}

uint64_t Scene::placed_triangle_count() const {
    uint64_t sum = 0;
    for (const Instance& instance : instances) sum += meshes[instance.mesh].triangle_count;
    return sum;
}

Bounds Scene::bounds() const {
    Bounds box;
    std::vector<std::vector<rt_u32>> vertices_of(meshes.size());
    for (const Instance& instance : instances) {
        const Mesh& mesh = meshes[instance.mesh];
        std::vector<rt_u32>& vertices = vertices_of[instance.mesh];
        if (vertices.empty() && mesh.triangle_count != 0) vertices = used_vertices(*this, mesh);
        for (const rt_u32 v : vertices) {
            const std::array<float, 3> p = transform_point(instance.world_from_object, &positions[3 * size_t(v)]);
            box.add(p.data());
        }
    }
    for (const Polygon& polygon : polygons) {
        for (rt_u32 i = 0; i < polygon.corner_count; ++i) box.add(&polygon_corners[3 * (size_t(polygon.first_corner) + i)]);
    }
    for (const Sphere& sphere : spheres) {
        for (const float sign : {-1.f, 1.f}) {
            const std::array<float, 3> p = {sphere.center[0] + sign * sphere.radius, sphere.center[1] + sign * sphere.radius,
                                            sphere.center[2] + sign * sphere.radius};
            box.add(p.data());
        }
    }
    for (const Shape& shape : shapes) {
        const Bounds own = shape_bounds(*this, shape);
        for (int corner = 0; corner < 8 && !own.empty; ++corner) {
            const float p[3] = {(corner & 1 ? own.max : own.min)[0], (corner & 2 ? own.max : own.min)[1],
                                (corner & 4 ? own.max : own.min)[2]};
            box.add(transform_point(shape.world_from_object, p).data());
        }
    }
    return box;
}

double Scene::surface_area() const {
    double sum = 0;
    std::vector<double> unscaled(meshes.size(), -1);
    for (const Instance& instance : instances) {
        const Mesh& mesh = meshes[instance.mesh];
        const double scale = uniform_scale(instance.world_from_object);
        if (scale < 0) {
            sum += mesh_area(*this, mesh, instance.world_from_object);
            continue;
        }
        double& area = unscaled[instance.mesh];
        if (area < 0) area = mesh_area(*this, mesh, kIdentity);
        sum += area * scale * scale;
    }
    for (const Polygon& polygon : polygons) {
        const float* corners = &polygon_corners[3 * size_t(polygon.first_corner)];
        Vec doubled{};
        for (rt_u32 i = 2; i < polygon.corner_count; ++i) {
            const Vec origin = to_vec(corners);
            const Vec n = cross(to_vec(corners + 3 * (size_t(i) - 1)) - origin, to_vec(corners + 3 * size_t(i)) - origin);
            doubled = {doubled[0] + n[0], doubled[1] + n[1], doubled[2] + n[2]};
        }
        sum += 0.5 * length(doubled);
    }
    for (const Sphere& sphere : spheres) sum += 4 * kPi * double(sphere.radius) * sphere.radius;
    return sum;
}

void note_used_materials(Scene& scene) {
    for (Material& material : scene.materials) material.used = false;
    std::vector<bool> counted(scene.meshes.size());
    for (const Instance& instance : scene.instances) {
        if (instance.material != RT_NONE) {
            scene.materials[instance.material].used = true;
            continue;
        }
        if (counted[instance.mesh]) continue;
        counted[instance.mesh] = true;
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (rt_u32 i = 0; i < mesh.triangle_count; ++i)
            scene.materials[scene.triangle_materials[mesh.first_triangle + i]].used = true;
    }
    const auto note = [&](const auto& primitives) {
        for (const auto& primitive : primitives) scene.materials[primitive.material].used = true;
    };
    note(scene.spheres), note(scene.polygons), note(scene.planes), note(scene.shapes);
}

PrimNumbers::PrimNumbers(const Scene& scene) {
    static_assert(slot(PrimPlace::Kind::shape) == kKinds - 1, "all kinds are added here");
    uint64_t next = 0;
    const auto add = [&](uint64_t count) {
        first_.push_back(next);
        next += count;
    };
    first_.reserve(scene.instances.size() + kKinds + 1);
    for (const Instance& instance : scene.instances) add(scene.meshes[instance.mesh].triangle_count);
    for (const size_t count : {scene.spheres.size(), scene.polygons.size(), scene.planes.size(), scene.shapes.size()})
        add(count);
    first_.push_back(next);
}

PrimPlace PrimNumbers::place(rt_i32 prim) const {
    if (prim < 0 || uint64_t(prim) >= count()) return {};
    const size_t at = size_t(std::upper_bound(first_.begin(), first_.end(), uint64_t(prim)) - first_.begin()) - 1;
    PrimPlace place;
    place.index = static_cast<rt_u32>(uint64_t(prim) - first_[at]);
    if (at < instance_count())
        place.kind = PrimPlace::Kind::triangle, place.instance = static_cast<rt_u32>(at);
    else
        place.kind = PrimPlace::Kind(at - instance_count() + size_t(PrimPlace::Kind::sphere));
    return place;
}

PrimPlace place_of_prim(const Scene& scene, rt_i32 prim) {
    using Kind = PrimPlace::Kind;
    PrimPlace place = PrimNumbers(scene).place(prim);
    if (place.kind == Kind::triangle) {
        const Instance& instance = scene.instances[place.instance];
        place.index += scene.meshes[instance.mesh].first_triangle;
        place.material = instance.material == RT_NONE ? scene.triangle_materials[place.index] : instance.material;
    }
    if (place.kind == Kind::sphere) place.material = scene.spheres[place.index].material;
    if (place.kind == Kind::polygon) place.material = scene.polygons[place.index].material;
    if (place.kind == Kind::plane) place.material = scene.planes[place.index].material;
    if (place.kind == Kind::shape) place.material = scene.shapes[place.index].material;
    return place;
}

std::string texture_name(const Scene& scene, rt_u32 texture) {
    const bool has_name = texture < scene.texture_names.size() && !scene.texture_names[texture].empty();
    return has_name ? scene.texture_names[texture] : "texture " + std::to_string(texture);
}

uint64_t texel_count(const rt_texture& texture) {
    uint64_t count = 0, width = texture.width, height = texture.height;
    for (rt_u32 level = 0; level <= texture.levels; ++level) {
        if (width == 0 || height == 0) return 0;
        if (level > 0 && width == 1 && height == 1) return 0;
        if (level > 0) width = std::max<uint64_t>(width / 2, 1), height = std::max<uint64_t>(height / 2, 1);
        count += width * height;
    }
    return count;
}

Bounds instance_bounds(const Scene& scene, rt_u32 index) {
    Bounds box;
    const Instance& instance = scene.instances[index];
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (size_t i = 0; i < 3 * size_t(mesh.triangle_count); ++i) {
        const rt_u32 vertex = scene.triangles[3 * size_t(mesh.first_triangle) + i];
        box.add(transform_point(instance.world_from_object, &scene.positions[3 * size_t(vertex)]).data());
    }
    return box;
}

Bounds shape_bounds(const Scene& scene, const Shape& shape) {
    Bounds box;
    for (rt_u32 i = 0; i < shape.part_count; ++i) {
        box.add(scene.shape_parts[size_t(shape.first_part) + i].min.data());
        box.add(scene.shape_parts[size_t(shape.first_part) + i].max.data());
    }
    return box;
}

rt_light whitted_light(rt_u32 kind, const std::array<float, 3>& position, const std::array<float, 3>& color) {
    rt_light light{};
    light.kind = kind;
    std::copy(position.begin(), position.end(), light.position);
    std::copy(color.begin(), color.end(), light.color);
    return light;
}

}  // namespace clarity
