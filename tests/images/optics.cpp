#include "images/optics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace clarity::test {

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
    set_setting(settings, "min_weight", "0");
    Picture picture{width, height, {}, {}};
    picture.image = Workbench::get().values(shared_scene(scene), settings, view, &picture.stats);
    return picture;
}

void expect_picture(const Picture& picture, const View& view, const std::function<double(const Ray&)>& expected,
                    double tolerance, size_t least) {
    size_t compared = 0, wrong = 0;
    double worst = 0;
    char where[200] = "";
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const double wanted = expected(camera_ray(view.camera, picture.width, picture.height, x, y));
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
