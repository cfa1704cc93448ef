#include "images/optics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace clarity::test {

namespace {

Vec vec(const Point& p) {
    return {p[0], p[1], p[2]};
}

}  // namespace

Line pixel_line(const Camera& camera, int width, int height, int x, int y) {
    const Vec w = normalized(vec(camera.target) - vec(camera.eye)), u = normalized(cross(w, vec(camera.up))), v = cross(u, w);
    const double tangent = std::tan(0.5 * camera.fov_y_rad);
    const double sx = (2 * (x + 0.5) / width - 1) * tangent * width / height, sy = (1 - 2 * (y + 0.5) / height) * tangent;
    return {vec(camera.eye), normalized(w + sx * u + sy * v)};
}

double meet_sphere(const Line& line, const Vec& center, double radius, double* margin) {
    const Vec to = center - line.origin;
    const double along = dot(to, line.direction);
    const double distance = std::sqrt(std::max(0.0, dot(to, to) - along * along));
    if (margin) *margin = std::fabs(distance - radius) / radius;
    if (distance > radius) return INFINITY;
    const double half = std::sqrt(radius * radius - distance * distance);
    return along - half > 0 ? along - half : along + half > 0 ? along + half : INFINITY;
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

std::array<float, 3> Picture::at(int x, int y) const {
    const float* p = &image.pixels[3 * (size_t(y) * width + x)];
    return {p[0], p[1], p[2]};
}

Picture trace(const Scene& scene, const View& view, int width, int height, int depth,
              const std::vector<std::pair<std::string, std::string>>& pairs) {
    Settings settings = make_settings(pairs);
    settings.width = width;
    settings.height = height;
    settings.depth = depth;
    settings.min_weight = 0;
    Picture picture{width, height, {}, {}};
    picture.image = Workbench::get().values(shared_scene(scene), settings, view, &picture.stats);
    return picture;
}

void expect_picture(const Picture& picture, const View& view, const std::function<double(const Line&)>& expected,
                    double tolerance, size_t least) {
    size_t compared = 0, wrong = 0;
    double worst = 0;
    char where[200] = "";
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const double wanted = expected(pixel_line(view.camera, picture.width, picture.height, x, y));
            if (wanted < 0) continue;
            ++compared;
            const double difference = std::fabs(picture.at(x, y)[1] - wanted);
            wrong += !(difference <= tolerance);
            if (!(difference <= worst)) {
                worst = difference;
                std::snprintf(where, sizeof where, "pixel %d,%d is %.6f instead of %.6f", x, y, double(picture.at(x, y)[1]),
                              wanted);
            }
        }
    EXPECT_GE(compared, least) << "too few pixels to prove anything";
    EXPECT_EQ(wrong, 0u) << "of " << compared << "; worst: " << where;
}

}  // namespace clarity::test
