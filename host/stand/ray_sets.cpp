#include "stand/ray_sets.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"
#include "base/lowbias32.hpp"
#include "base/parallel_for.hpp"
#include "scene/light_kinds.hpp"
#include "stand/seed.hpp"

namespace clarity {
namespace {

constexpr int kTile = 16;        // pixels, width and height
constexpr size_t kPacket = 16;   // rays per packet; an inactive ray copies an active ray of its packet
constexpr size_t kChunk = 4096;  // rays per task

rt_ray make_ray(const Vec& origin, const Vec& direction, double t_max) {
    rt_ray ray{};
    for (int k = 0; k < 3; ++k) {
        ray.origin[k] = static_cast<float>(origin[k]);
        ray.direction[k] = static_cast<float>(direction[k]);
    }
    ray.t_max = static_cast<float>(t_max);
    return ray;
}

// Sets `active`, and gives inactive rays the origin and direction of an active ray of the same packet. Packets choose their
// traversal by origins and directions, so that inactive rays must not stand out.
void settle(RaySet& set) {
    set.active = 0;
    for (size_t first = 0; first < set.rays.size(); first += kPacket) {
        const size_t end = std::min(first + kPacket, set.rays.size());
        const auto active = [](const rt_ray& ray) { return is_active(ray); };
        const auto some = std::find_if(set.rays.begin() + first, set.rays.begin() + end, active);
        rt_ray like = some != set.rays.begin() + end ? *some : make_ray({0, 0, 0}, {0, 0, 1}, -1);
        like.t_max = -1;
        for (size_t i = first; i < end; ++i) {
            if (is_active(set.rays[i]))
                ++set.active;
            else
                set.rays[i] = like;
        }
    }
}

rt_u32 even_bits(rt_u32 z) {
    rt_u32 x = 0;
    for (int bit = 0; bit < 4; ++bit) x |= (z >> (2 * bit) & 1u) << bit;
    return x;
}

Vec cosine_direction(const Vec& normal, rt_u32 pixel) {
    const double u1 = lowbias32(2 * pixel + 1) * 0x1p-32, u2 = lowbias32(2 * pixel + 2) * 0x1p-32;
    const double r = std::sqrt(u1), phi = 2 * kPi * u2;
    const Vec side = std::fabs(normal[0]) > 0.9 ? Vec{0, 1, 0} : Vec{1, 0, 0};
    const Vec tangent = normalized(cross(side, normal), {1, 0, 0}), bitangent = cross(normal, tangent);
    return normalized(r * std::cos(phi) * tangent + r * std::sin(phi) * bitangent + std::sqrt(1 - u1) * normal, normal);
}

}  // namespace

RayMaker::RayMaker(unsigned own, uint64_t seed) : random_(random_of(own, seed)) {}

float RayMaker::any() {
    return std::uniform_real_distribution<float>(0, 1)(random_);
}

size_t RayMaker::below(size_t n) {
    return std::uniform_int_distribution<size_t>(0, n - 1)(random_);
}

Point RayMaker::direction() {
    Point d;
    float length = 0;
    do {
        for (float& c : d) c = std::normal_distribution<float>()(random_);
        length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    } while (length < 1e-3f);
    for (float& c : d) c /= length;
    return d;
}

Point RayMaker::within(const Region& region, float share) {
    Point p = region.center;
    for (float& c : p) c += share * region.radius * (2 * any() - 1);
    return p;
}

rt_ray RayMaker::from_to(const Point& from, const Point& to) {
    rt_ray ray = ray_of(from, {to[0] - from[0], to[1] - from[1], to[2] - from[2]});
    const float length = std::sqrt(ray.direction[0] * ray.direction[0] + ray.direction[1] * ray.direction[1] +
                                   ray.direction[2] * ray.direction[2]);
    if (length > 0)
        for (float& d : ray.direction) d /= length;
    return ray;
}

rt_ray RayMaker::along(const Point& d, const Region& region, float away) {
    const Point to = within(region, 0.8f);
    Point from = to;
    for (int k = 0; k < 3; ++k) from[k] -= away * region.radius * d[k];
    return from_to(from, to);
}

std::vector<rt_ray> random_rays(const Bounds& box, size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> at(-0.3f, 1.3f), any(0, 1);
    std::normal_distribution<float> normal;
    std::vector<rt_ray> rays(count);
    for (rt_ray& ray : rays) {
        float length = 0;
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = box.min[k] + at(random) * (box.max[k] - box.min[k]);
            ray.direction[k] = normal(random);
            length += ray.direction[k] * ray.direction[k];
        }
        const float scale = (any(random) < 0.5f ? 1 : 1 + 9 * any(random)) / std::sqrt(length);
        for (float& d : ray.direction) d *= scale;
        ray.t_min = 0;
        ray.t_max = INFINITY;
    }
    return rays;
}

std::vector<rt_u32> ray_order(int width, int height) {
    std::vector<rt_u32> order;
    for (int tile_y = 0; tile_y < height; tile_y += kTile)
        for (int tile_x = 0; tile_x < width; tile_x += kTile)
            for (rt_u32 z = 0; z < kTile * kTile; ++z) {
                const rt_u32 x = tile_x + even_bits(z), y = tile_y + even_bits(z >> 1);
                const bool inside = x < rt_u32(width) && y < rt_u32(height);
                order.push_back(inside ? y * rt_u32(width) + x : RT_NONE);
            }
    return order;
}

RaySet camera_rays(const Camera& camera, int width, int height) {
    const Vec eye = to_vec(camera.eye.data());
    const Vec w = normalized(to_vec(camera.target.data()) - eye, {0, 0, -1});
    const Vec u = normalized(cross(w, to_vec(camera.up.data())), std::fabs(w[0]) < 0.9 ? Vec{1, 0, 0} : Vec{0, 0, 1});
    const Vec v = cross(u, w);
    const double tangent = std::tan(0.5 * camera.fov_y_rad), aspect = double(width) / height;
    RaySet set;
    set.kind = "primary";
    for (const rt_u32 pixel : ray_order(width, height)) {
        const rt_u32 x = pixel % rt_u32(width), y = pixel / rt_u32(width);
        const double across = (2 * (x + 0.5) / width - 1) * tangent * aspect, up = (1 - 2 * (y + 0.5) / height) * tangent;
        set.rays.push_back(make_ray(eye, normalized(w + across * u + up * v, w), pixel == RT_NONE ? -1 : INFINITY));
    }
    settle(set);
    return set;
}

Vec SurfaceNormals::at(rt_i32 prim, const Vec& point) const {
    const Vec otherwise{0, 1, 0};
    const PrimPlace place = numbers_.place(prim);
    switch (place.kind) {
        case PrimPlace::Kind::triangle: {
            const Instance& instance = scene_.instances[place.instance];
            const size_t triangle = scene_.meshes[instance.mesh].first_triangle + size_t(place.index);
            Vec corners[3];
            for (int c = 0; c < 3; ++c) {
                const float* p = &scene_.positions[3 * size_t(scene_.triangles[3 * triangle + c])];
                corners[c] = to_vec(transform_point(instance.world_from_object, p).data());
            }
            return normalized(cross(corners[1] - corners[0], corners[2] - corners[0]), otherwise);
        }
        case PrimPlace::Kind::sphere:
            return normalized(point - to_vec(scene_.spheres[place.index].center.data()), otherwise);
        case PrimPlace::Kind::polygon: {
            const Polygon& polygon = scene_.polygons[place.index];
            const float* corners = &scene_.polygon_corners[3 * size_t(polygon.first_corner)];
            Vec sum{};
            for (rt_u32 c = 0; c < polygon.corner_count; ++c)
                sum = sum + cross(to_vec(corners + 3 * c) - to_vec(corners),
                                  to_vec(corners + 3 * ((c + 1) % polygon.corner_count)) - to_vec(corners));
            return normalized(sum, otherwise);
        }
        case PrimPlace::Kind::plane:
            return normalized(to_vec(scene_.planes[place.index].normal.data()), otherwise);
        default:
            return otherwise;
    }
}

bool SurfaceNormals::is_shape(rt_i32 prim) const {
    return numbers_.place(prim).kind == PrimPlace::Kind::shape;
}

namespace {

Vec point_of(const rt_ray& ray, const rt_hit& hit) {
    return to_vec(ray.origin) + double(hit.t) * to_vec(ray.direction);
}

// Of hits on shapes, in the order of the rays; 0 of all others. From the points that rays a thousandth to the left, right,
// above and below hit on the same shape.
std::vector<Vec> shape_normals(const SurfaceNormals& normals, const RaySet& primary, const std::vector<rt_hit>& hits,
                               const TraceRays& trace) {
    constexpr double kAside = 1e-3;
    std::vector<Vec> along[2];  // of each ray, tangents of the surface
    for (int axis = 0; axis < 2; ++axis) {
        along[axis].assign(hits.size(), {0, 0, 0});
        for (const double sign : {1.0, -1.0}) {
            std::vector<rt_ray> aside = primary.rays;
            for (rt_ray& ray : aside) {
                const Vec direction = to_vec(ray.direction);
                const Vec u =
                    normalized(cross(direction, std::fabs(direction[1]) < 0.9 ? Vec{0, 1, 0} : Vec{1, 0, 0}), {1, 0, 0});
                ray =
                    make_ray(to_vec(ray.origin), direction + sign * kAside * (axis == 0 ? u : cross(u, direction)), ray.t_max);
            }
            const std::vector<rt_hit> there = trace(aside);
            for (size_t i = 0; i < hits.size(); ++i)
                if (normals.is_shape(hits[i].prim) && there[i].prim == hits[i].prim)
                    along[axis][i] =
                        along[axis][i] + sign * (point_of(aside[i], there[i]) - point_of(primary.rays[i], hits[i]));
        }
    }
    std::vector<Vec> found(hits.size(), Vec{0, 0, 0});
    for (size_t i = 0; i < hits.size(); ++i)
        if (normals.is_shape(hits[i].prim))
            found[i] = normalized(cross(along[0][i], along[1][i]), -to_vec(primary.rays[i].direction));
    return found;
}

}  // namespace

std::vector<RaySet> secondary_rays(const Scene& scene, const rt_light& light, const RaySet& primary, int width, int height,
                                   const TraceRays& trace) {
    const std::vector<rt_hit> hits = trace(primary.rays);
    const SurfaceNormals normals(scene);
    std::vector<Vec> of_shapes;
    if (!scene.shapes.empty()) of_shapes = shape_normals(normals, primary, hits, trace);
    const Bounds bounds = scene.bounds();
    const double eps = 1e-4 * (bounds.empty ? 1.0 : double(bounds.diagonal()));
    const std::vector<rt_u32> order = ray_order(width, height);
    std::vector<RaySet> sets(3);
    const char* const kinds[] = {"shadow", "reflection", "diffuse"};
    for (int k = 0; k < 3; ++k) {
        sets[k].kind = kinds[k];
        sets[k].rays.assign(primary.rays.size(), make_ray({0, 0, 0}, {0, 0, 1}, -1));
    }
    sets[0].any_hit = true;
    const size_t count = primary.rays.size();
    parallel_for(static_cast<uint32_t>((count + kChunk - 1) / kChunk), [&](uint32_t chunk) {
        for (size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
            const rt_ray& ray = primary.rays[i];
            if (!is_active(ray) || !std::isfinite(hits[i].t) || hits[i].prim < 0) continue;
            const Vec direction = to_vec(ray.direction), point = point_of(ray, hits[i]);
            Vec normal = normals.is_shape(hits[i].prim) ? of_shapes[i] : normals.at(hits[i].prim, point);
            if (dot(normal, direction) > 0) normal = -normal;
            const Vec origin = point + eps * normal;
            const bool has_place = light_kind_of(light).has_place;
            const Vec to_light = has_place ? to_vec(light.position) - origin : to_vec(light.position);
            const double distance = has_place ? length(to_light) : INFINITY;
            sets[0].rays[i] = make_ray(origin, normalized(to_light, normal), distance);
            sets[1].rays[i] = make_ray(origin, direction - 2 * dot(direction, normal) * normal, INFINITY);
            sets[2].rays[i] = make_ray(origin, cosine_direction(normal, order[i]), INFINITY);
        }
    });
    for (RaySet& set : sets) settle(set);
    return sets;
}

}  // namespace clarity
