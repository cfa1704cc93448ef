#include "check/hits/report_picture.hpp"

#include <algorithm>
#include <cmath>

#include "check/hits/brute_force.hpp"
#include "check/hits/judge.hpp"
#include "render/film/image_io.hpp"
#include "scene/vec.hpp"

namespace clarity::check {
namespace {

// Odd, so that the ray itself is the one in the middle.
constexpr int kWidth = 241, kHeight = 181;
constexpr double kHalfHeight = 0.3;  // tangent of half the vertical angle of view

// One ray for each pixel, the top row first.
std::vector<rt_ray> rays_around(const rt_ray& ray) {
    const Vec along = to_vec(ray.direction), w = normalized(along);
    const Vec u = normalized(cross(w, std::fabs(w[1]) < 0.9 ? Vec{0, 1, 0} : Vec{1, 0, 0})), v = cross(u, w);
    std::vector<rt_ray> rays;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double right = kHalfHeight * (2 * (x + 0.5) - kWidth) / kHeight;
            const double above = kHalfHeight * (kHeight - 2 * (y + 0.5)) / kHeight;
            rt_ray pixel = ray;
            if (right != 0 || above != 0) {
                const Vec turned = length(along) * (w + right * u + above * v);
                for (size_t k = 0; k < 3; ++k) pixel.direction[k] = static_cast<float>(turned[k]);
            }
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
        const Fault fault = judge(rays[i], truths[i], traced.hits[i], any_hit);
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
