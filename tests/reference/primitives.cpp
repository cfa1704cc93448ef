#include "reference/primitives.hpp"

#include <algorithm>

namespace clarity::test {
namespace {

bool is_within(const Ray& ray, double t) {
    return t > 0 && t >= ray.t_min && t <= ray.t_max;
}

}  // namespace

Ray widened(const rt_ray& ray) {
    return {to_vec(ray.origin), to_vec(ray.direction), ray.t_min, ray.t_max};
}

Ray camera_ray(const Camera& camera, int width, int height, int x, int y) {
    const Vec eye = to_vec(camera.eye), w = normalized(to_vec(camera.target) - eye);
    const Vec u = normalized(cross(w, to_vec(camera.up))), v = cross(u, w);
    const double tangent = std::tan(0.5 * camera.fov_y_rad);
    const double sx = (2 * (x + 0.5) / width - 1) * tangent * width / height, sy = (1 - 2 * (y + 0.5) / height) * tangent;
    return {eye, normalized(w + sx * u + sy * v)};
}

double hit_sphere(const Vec& center, double radius, const Ray& ray, double* margin) {
    const Vec from = ray.origin - center;
    const double a = dot(ray.direction, ray.direction), along = -dot(from, ray.direction) / a;
    const Vec nearest = from + along * ray.direction;
    if (margin) *margin = std::fabs(length(nearest) - radius) / radius;
    const double room = radius * radius - dot(nearest, nearest);
    if (!(room >= 0)) return INFINITY;
    const double half = std::sqrt(room / a);
    for (const double t : {along - half, along + half})
        if (is_within(ray, t)) return t;
    return INFINITY;
}

double fresnel(double cos_in, double eta) {
    const double sin2 = eta * eta * (1 - cos_in * cos_in);
    if (sin2 >= 1) return 1;
    const double cos_out = std::sqrt(1 - sin2);
    const double s = (eta * cos_in - cos_out) / (eta * cos_in + cos_out),
                 p = (eta * cos_out - cos_in) / (eta * cos_out + cos_in);
    return 0.5 * (s * s + p * p);
}

Vec refracted(const Vec& direction, const Vec& normal, double eta) {
    const double cos_in = -dot(direction, normal), cos_out = std::sqrt(1 - eta * eta * (1 - cos_in * cos_in));
    return normalized(eta * direction + (eta * cos_in - cos_out) * normal);
}

std::vector<float> world_corners(const Scene& scene) {
    std::vector<float> corners;
    corners.reserve(9 * scene.placed_triangle_count());
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        const bool placed = instance.world_from_object != kIdentity;
        for (size_t i = 0; i < 3 * size_t(mesh.triangle_count); ++i) {
            const float* p = &scene.positions[3 * size_t(scene.triangles[3 * size_t(mesh.first_triangle) + i])];
            for (int k = 0; k < 3; ++k) {
                const float* m = &instance.world_from_object[4 * k];
                corners.push_back(
                    placed ? static_cast<float>(double(m[0]) * p[0] + double(m[1]) * p[1] + double(m[2]) * p[2] + m[3]) : p[k]);
            }
        }
    }
    return corners;
}

double hit_triangle(const float* corners, const Ray& ray, double slack, double weights[2]) {
    const Vec a = to_vec(corners), ab = to_vec(corners + 3) - a, ac = to_vec(corners + 6) - a;
    const Vec n = cross(ab, ac);
    const double facing = dot(n, ray.direction);
    if (facing == 0) return INFINITY;
    const Vec to_a = a - ray.origin;
    const double t = dot(n, to_a) / facing;
    const Vec across = cross(ray.direction, to_a);
    const double v = -dot(ac, across) / facing, w = dot(ab, across) / facing;
    const bool inside = v >= -slack && w >= -slack && v + w <= 1 + slack;
    if (weights) weights[0] = v, weights[1] = w;
    return inside && t >= ray.t_min && t <= ray.t_max ? t : INFINITY;
}

Primitives::Primitives(const Scene& scene)
    : scene_(scene), numbers_(scene), corners_(world_corners(scene)), triangle_count_(static_cast<int>(corners_.size() / 9)) {}

Vec Primitives::polygon_normal(const Polygon& polygon) const {
    const float* corners = &scene_.polygon_corners[3 * size_t(polygon.first_corner)];
    Vec normal{};
    for (rt_u32 c = 0; c < polygon.corner_count; ++c)
        normal = normal + cross(to_vec(corners + 3 * c), to_vec(corners + 3 * ((c + 1) % polygon.corner_count)));
    return normal;
}

double Primitives::hit_polygon(const Polygon& polygon, const Ray& ray) const {
    const float* corners = &scene_.polygon_corners[3 * size_t(polygon.first_corner)];
    const rt_u32 count = polygon.corner_count;
    const Vec normal = polygon_normal(polygon), n = normalized(normal);
    Vec centroid{};
    for (rt_u32 c = 0; c < count; ++c) centroid = centroid + (1.0 / count) * to_vec(corners + 3 * c);
    const double t = dot(normal, centroid - ray.origin) / dot(normal, ray.direction);
    if (!is_within(ray, t)) return INFINITY;
    // Winding number: the sum of the angles at which the point sees the edges, in the polygon's plane, is 0 or a multiple of a
    // full turn. The kernels use another method; they count crossings.
    const Vec p = ray.at(t);
    double angle = 0;
    for (rt_u32 c = 0; c < count; ++c) {
        const Vec a = to_vec(corners + 3 * c) - p, b = to_vec(corners + 3 * ((c + 1) % count)) - p;
        angle += std::atan2(dot(n, cross(a, b)), dot(a, b));
    }
    return std::lround(angle / 6.283185307179586) % 2 != 0 ? t : INFINITY;
}

double Primitives::distance(int prim, const Ray& ray, double slack) const {
    if (prim < 0) return INFINITY;
    if (prim < triangle_count_) return hit_triangle(corners(prim), ray, slack);
    const PrimPlace place = numbers_.place(prim);
    const size_t i = place.index;
    if (place.kind == PrimPlace::Kind::sphere)
        return hit_sphere(to_vec(scene_.spheres[i].center), scene_.spheres[i].radius, ray);
    if (place.kind == PrimPlace::Kind::polygon) return hit_polygon(scene_.polygons[i], ray);
    if (place.kind != PrimPlace::Kind::plane) return INFINITY;
    const Plane& plane = scene_.planes[i];
    const Vec n = to_vec(plane.normal);
    const double t = (plane.offset - dot(n, ray.origin)) / dot(n, ray.direction);
    return is_within(ray, t) ? t : INFINITY;
}

Truth Primitives::nearest(const Ray& ray, int first) const {
    const uint64_t end = numbers_.first(PrimPlace::Kind::shape);
    Truth best;
    for (int i = first; i < static_cast<int>(end); ++i) {
        const double t = distance(i, ray, 0);
        if (t < best.t) best = {t, i};
    }
    return best;
}

}  // namespace clarity::test
