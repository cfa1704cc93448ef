#include "images/optics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "images/quick_scene.hpp"

namespace clarity::test {

std::array<float, 3> Picture::at(int x, int y) const {
    const float* p = &image.pixels[3 * (size_t(y) * width + x)];
    return {p[0], p[1], p[2]};
}

Picture trace(const Scene& scene, const View& view, int width, int height, int depth,
              const std::vector<std::pair<std::string, std::string>>& pairs) {
    Settings settings = make_settings(pairs);
    // Those that most of these tests name, so that quick ones share programs.
    if (few_ways() &&
        std::none_of(pairs.begin(), pairs.end(), [](const auto& p) { return p.first == "lanes" || p.first == "tracer"; }))
        settings.lanes = 8;
    settings.width = width;
    settings.height = height;
    settings.depth = depth;
    set_setting(settings, "min_weight", "0");
    Picture picture{width, height, {}, {}};
    picture.image = Workbench::get().values(shared_scene(with_all_of_textures(scene, view)), settings, view, &picture.stats);
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

Scene white_square(const Affine& placed) {
    TriangleMesh mesh;
    mesh.add_quad(Vec{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0});
    Scene scene = scene_of(mesh);
    scene.uvs = {0, 0, 1, 0, 1, 1, 0, 1};
    scene.instances[0].world_from_object = placed;
    scene.materials[0].values = diffuse(1, 1, 1);
    return scene;
}

View view_of_square() {
    View view = view_from({1, 1, 5}, {1, 1, 0}, 2 * std::atan(1.0 / 5) * 180 / 3.14159265358979);
    view.background = {0, 0, 0};
    view.ambient = {1, 1, 1};
    return view;
}

}  // namespace clarity::test
