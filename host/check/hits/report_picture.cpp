#include "check/hits/report_picture.hpp"

#include <algorithm>
#include <cmath>

#include "check/hits/brute_force.hpp"
#include "check/hits/judge.hpp"
#include "render/film/image_io.hpp"

namespace clarity::check {
namespace {

// Odd, so that the ray itself is the one in the middle.
constexpr int kWidth = 241, kHeight = 181;
constexpr double kHalfHeight = 0.3;  // tangent of half the vertical angle of view

// One ray for each pixel, the top row first.
std::vector<rt_ray> rays_around(const rt_ray& ray) {
    double w[3], u[3], v[3], length = 0;
    for (int k = 0; k < 3; ++k) length += double(ray.direction[k]) * double(ray.direction[k]);
    length = std::sqrt(length);
    for (int k = 0; k < 3; ++k) w[k] = double(ray.direction[k]) / length;
    const bool upright = std::fabs(w[1]) < 0.9;  // otherwise x is up
    const double up[3] = {upright ? 0.0 : 1.0, upright ? 1.0 : 0.0, 0};
    for (int k = 0; k < 3; ++k) u[k] = w[(k + 1) % 3] * up[(k + 2) % 3] - w[(k + 2) % 3] * up[(k + 1) % 3];
    const double across = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (double& x : u) x /= across;
    for (int k = 0; k < 3; ++k) v[k] = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
    std::vector<rt_ray> rays;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double right = kHalfHeight * (2 * (x + 0.5) - kWidth) / kHeight;
            const double above = kHalfHeight * (kHeight - 2 * (y + 0.5)) / kHeight;
            rt_ray pixel = ray;
            if (right != 0 || above != 0)
                for (int k = 0; k < 3; ++k)
                    pixel.direction[k] = static_cast<float>(length * (w[k] + right * u[k] + above * v[k]));
            rays.push_back(pixel);
        }
    return rays;
}

}  // namespace

ReportPicture write_report_picture(const std::string& path, CheckedScene& scene, const Variant& variant, const rt_ray& ray,
                                   bool any_hit) {
    const std::vector<rt_ray> rays = rays_around(ray);
    const std::vector<Truth> truths = BruteForce(scene.build_scene()).trace(rays);
    const Traced traced = scene.trace(variant, rays, any_hit);
    double nearest = INFINITY;
    for (const Truth& truth : truths)
        if (!truth.contacts.empty()) nearest = std::min(nearest, std::max(truth.contacts.front().t, 0.0));
    ReportPicture report;
    report.pixels = rays.size();
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i < rays.size(); ++i) {
        const Fault fault = any_hit ? judge_any(truths[i], traced.hits[i]) : judge_nearest(rays[i], truths[i], traced.hits[i]);
        uint8_t grey = 24;  // nothing is hit
        if (!truths[i].contacts.empty()) {
            const Contact& contact = truths[i].contacts.front();
            const double near = (nearest + 1e-3) / (std::max(contact.t, 0.0) + 1e-3);  // 1 for what is nearest
            // Neighbouring primitives differ a little.
            const auto shade = static_cast<unsigned>(contact.prim) * 2654435761u >> 27;
            grey = static_cast<uint8_t>(std::clamp(70 + 130 * near + shade, 70.0, 230.0));
        }
        const bool differs = fault != Fault::none;
        report.differing += differs;
        const uint8_t pixel[4] = {differs ? uint8_t(255) : grey, differs ? uint8_t(0) : grey, differs ? uint8_t(0) : grey, 255};
        bytes.insert(bytes.end(), pixel, pixel + 4);
    }
    write_image(path, {}, ByteImage{kWidth, kHeight, SharedBytes(std::move(bytes))});
    return report;
}

}  // namespace clarity::check
