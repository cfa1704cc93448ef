#include "conformance/oracle.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "base/parallel_for.hpp"

namespace clarity::test {
namespace {

using Vec = std::array<double, 3>;

Vec operator-(const Vec& a, const Vec& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec operator+(const Vec& a, const Vec& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vec operator*(double s, const Vec& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec normalized(const Vec& a) {
    return (1 / std::sqrt(dot(a, a))) * a;
}
Vec vec(const float* p) {
    return {p[0], p[1], p[2]};
}

// Distance to a triangle that is widened by `slack`, relative to its size; +inf if it is missed.
double hit_triangle(const float* corners, const Ray& ray, double slack) {
    const Vec a = vec(corners), ab = vec(corners + 3) - a, ac = vec(corners + 6) - a;
    const Vec n = cross(ab, ac);
    const double facing = dot(n, ray.direction);
    if (facing == 0) return INFINITY;
    const Vec to_a = a - ray.origin;
    const double t = dot(n, to_a) / facing;
    const Vec across = cross(ray.direction, to_a);
    const double v = -dot(ac, across) / facing, w = dot(ab, across) / facing;
    const bool inside = v >= -slack && w >= -slack && v + w <= 1 + slack;
    return inside && t >= ray.t_min && t <= ray.t_max ? t : INFINITY;
}

}  // namespace

Ray widened(const rt_ray& ray) {
    Ray wide;
    for (int k = 0; k < 3; ++k) {
        wide.origin[k] = ray.origin[k];
        wide.direction[k] = ray.direction[k];
    }
    wide.t_min = ray.t_min;
    wide.t_max = ray.t_max;
    return wide;
}

Ray camera_ray(const Camera& camera, int width, int height, int x, int y) {
    Ray ray;
    ray.origin = vec(camera.eye.data());
    const Vec w = normalized(vec(camera.target.data()) - ray.origin);
    const Vec u = normalized(cross(w, vec(camera.up.data())));
    const Vec v = cross(u, w);
    const double tangent = std::tan(0.5 * camera.fov_y_rad);
    const double sx = (2 * (x + 0.5) / width - 1) * tangent * width / height, sy = (1 - 2 * (y + 0.5) / height) * tangent;
    ray.direction = normalized(w + sx * u + sy * v);
    return ray;
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

Oracle::Oracle(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)), corners_(world_corners(*scene_)) {
    triangle_count_ = static_cast<int>(corners_.size() / 9);
    device_ = rtcNewDevice("threads=2");
    if (!device_) throw std::runtime_error("Embree gives no device: error " + std::to_string(rtcGetDeviceError(nullptr)));
    embree_ = rtcNewScene(device_);
    rtcSetSceneFlags(embree_, RTC_SCENE_FLAG_ROBUST);
    if (triangle_count_ > 0) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        const size_t corner_count = 3 * size_t(triangle_count_);
        void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, corner_count);
        auto* indices = static_cast<unsigned*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, size_t(triangle_count_)));
        std::memcpy(vertices, corners_.data(), corners_.size() * sizeof(float));
        for (unsigned i = 0; i < corner_count; ++i) indices[i] = i;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(embree_, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(embree_);
    const RTCError error = rtcGetDeviceError(device_);
    if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree refuses the scene: error " + std::to_string(error));
}

Oracle::~Oracle() {
    rtcReleaseScene(embree_);
    rtcReleaseDevice(device_);
}

Truth Oracle::closest_triangle(const Ray& ray) const {
    alignas(16) RTCRayHit query{};
    query.ray.org_x = static_cast<float>(ray.origin[0]);
    query.ray.org_y = static_cast<float>(ray.origin[1]);
    query.ray.org_z = static_cast<float>(ray.origin[2]);
    query.ray.dir_x = static_cast<float>(ray.direction[0]);
    query.ray.dir_y = static_cast<float>(ray.direction[1]);
    query.ray.dir_z = static_cast<float>(ray.direction[2]);
    query.ray.tnear = static_cast<float>(ray.t_min);
    query.ray.tfar = static_cast<float>(ray.t_max);
    query.ray.mask = ~0u;
    query.hit.geomID = query.hit.primID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(embree_, &context, &query);
    Truth truth;
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
        truth.t = query.ray.tfar;
        truth.prim = static_cast<int>(query.hit.primID);
    }
    return truth;
}

double Oracle::hit_sphere(size_t i, const Ray& ray) const {
    const Sphere& sphere = scene_->spheres[i];
    const Vec from = ray.origin - vec(sphere.center.data());
    const double a = dot(ray.direction, ray.direction), along = -dot(from, ray.direction) / a;
    const Vec nearest = from + along * ray.direction;
    const double room = double(sphere.radius) * sphere.radius - dot(nearest, nearest);
    if (!(room >= 0)) return INFINITY;
    const double half = std::sqrt(room / a);
    for (const double t : {along - half, along + half})
        if (t > 0 && t >= ray.t_min && t <= ray.t_max) return t;
    return INFINITY;
}

double Oracle::hit_plane(size_t i, const Ray& ray) const {
    const Plane& plane = scene_->planes[i];
    const Vec n = vec(plane.normal.data());
    const double t = (plane.offset - dot(n, ray.origin)) / dot(n, ray.direction);
    return t > 0 && t >= ray.t_min && t <= ray.t_max ? t : INFINITY;
}

double Oracle::hit_polygon(size_t i, const Ray& ray) const {
    const Polygon& polygon = scene_->polygons[i];
    const float* corners = &scene_->polygon_corners[3 * size_t(polygon.first_corner)];
    const rt_u32 count = polygon.corner_count;
    Vec normal{}, centroid{};
    for (rt_u32 c = 0; c < count; ++c) {
        normal = normal + cross(vec(corners + 3 * c), vec(corners + 3 * ((c + 1) % count)));
        centroid = centroid + (1.0 / count) * vec(corners + 3 * c);
    }
    const double t = dot(normal, centroid - ray.origin) / dot(normal, ray.direction);
    if (!(t > 0 && t >= ray.t_min && t <= ray.t_max)) return INFINITY;
    // Winding number: the sum of the angles at which the point sees the edges, in the polygon's plane, is 0 or a multiple of a
    // full turn. The kernels use another method; they count crossings.
    const Vec p = ray.origin + t * ray.direction, n = normalized(normal);
    double angle = 0;
    for (rt_u32 c = 0; c < count; ++c) {
        const Vec a = vec(corners + 3 * c) - p, b = vec(corners + 3 * ((c + 1) % count)) - p;
        angle += std::atan2(dot(n, cross(a, b)), dot(a, b));
    }
    const long turns = std::lround(angle / 6.283185307179586);
    return turns % 2 != 0 ? t : INFINITY;
}

void Oracle::closest_analytic(const Ray& ray, Truth& best) const {
    int prim = triangle_count_;
    const auto consider = [&](double t) {
        if (t < best.t) best = {t, prim};
        ++prim;
    };
    for (size_t i = 0; i < scene_->spheres.size(); ++i) consider(hit_sphere(i, ray));
    for (size_t i = 0; i < scene_->polygons.size(); ++i) consider(hit_polygon(i, ray));
    for (size_t i = 0; i < scene_->planes.size(); ++i) consider(hit_plane(i, ray));
}

Truth Oracle::closest(const Ray& ray) const {
    Truth best = closest_triangle(ray);
    closest_analytic(ray, best);
    return best;
}

std::vector<Truth> Oracle::picture(const Camera& camera, int width, int height) const {
    std::vector<Truth> pixels(size_t(width) * height);
    parallel_for(static_cast<uint32_t>(height), [&](uint32_t y) {
        for (int x = 0; x < width; ++x)
            pixels[size_t(y) * width + x] = closest(camera_ray(camera, width, height, x, static_cast<int>(y)));
    });
    return pixels;
}

bool Oracle::lies_at(int prim, const Ray& ray, double t, double slack) const {
    double found = INFINITY;
    size_t i = static_cast<size_t>(prim);
    if (prim < 0) return false;
    if (prim < triangle_count_) {
        found = hit_triangle(&corners_[9 * i], ray, 1e-3);
    } else if ((i -= triangle_count_) < scene_->spheres.size()) {
        found = hit_sphere(i, ray);
    } else if ((i -= scene_->spheres.size()) < scene_->polygons.size()) {
        found = hit_polygon(i, ray);
    } else if ((i -= scene_->polygons.size()) < scene_->planes.size()) {
        found = hit_plane(i, ray);
    }
    return std::fabs(found - t) <= slack * std::fabs(t);
}

bool Oracle::within_rounding(int prim, const Ray& ray, double t) const {
    if (prim < 0 || prim >= triangle_count_) return false;
    const float* corners = &corners_[9 * size_t(prim)];
    const Vec a = vec(corners), n = cross(vec(corners + 3) - a, vec(corners + 6) - a);
    const double height = dot(n, a - ray.origin), rounding = 2.4e-7 * std::sqrt(dot(n, n) * dot(ray.direction, ray.direction));
    const double facing = std::fabs(dot(n, ray.direction));
    if (facing <= rounding) return true;
    return t >= std::fabs(height) / (facing + rounding) && t <= std::fabs(height) / (facing - rounding);
}

Truth Oracle::exact(const Ray& ray) const {
    Truth best;
    for (int i = 0; i < triangle_count_; ++i) {
        const double t = hit_triangle(&corners_[9 * size_t(i)], ray, 0);
        if (t < best.t) best = {t, i};
    }
    closest_analytic(ray, best);
    return best;
}

}  // namespace clarity::test
