#include "conformance/oracle.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "base/parallel_for.hpp"

namespace clarity::test {
Oracle::Oracle(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)), primitives_(*scene_) {
    device_ = rtcNewDevice("threads=2");
    if (!device_) throw std::runtime_error("Embree gives no device: error " + std::to_string(rtcGetDeviceError(nullptr)));
    embree_ = rtcNewScene(device_);
    rtcSetSceneFlags(embree_, RTC_SCENE_FLAG_ROBUST);
    const auto triangle_count = static_cast<size_t>(primitives_.triangle_count());
    if (triangle_count > 0) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        const size_t corner_count = 3 * triangle_count;
        void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, corner_count);
        auto* indices = static_cast<unsigned*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangle_count));
        std::memcpy(vertices, primitives_.corners(0), 9 * triangle_count * sizeof(float));
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
    EmbreeQuery(false).closest(embree_, &query);
    Truth truth;
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
        truth.t = query.ray.tfar;
        truth.prim = static_cast<int>(query.hit.primID);
    }
    return truth;
}

Truth Oracle::closest(const Ray& ray) const {
    const Truth triangle = closest_triangle(ray), other = primitives_.nearest(ray, primitives_.triangle_count());
    return triangle.t <= other.t ? triangle : other;
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
    return std::fabs(primitives_.distance(prim, ray, 1e-3) - t) <= slack * std::fabs(t);
}

bool Oracle::within_rounding(int prim, const Ray& ray, double t) const {
    if (prim < 0 || prim >= primitives_.triangle_count()) return false;
    const float* corners = primitives_.corners(prim);
    const Vec a = to_vec(corners), n = cross(to_vec(corners + 3) - a, to_vec(corners + 6) - a);
    const double height = dot(n, a - ray.origin), rounding = 2.4e-7 * std::sqrt(dot(n, n) * dot(ray.direction, ray.direction));
    const double facing = std::fabs(dot(n, ray.direction));
    if (facing <= rounding) return true;
    return t >= std::fabs(height) / (facing + rounding) && t <= std::fabs(height) / (facing - rounding);
}

}  // namespace clarity::test
