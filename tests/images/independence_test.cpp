// independence_test.cpp -- the picture does not depend on the structure, lane count, packet size and tracer.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

struct Difference {
    size_t pixels = 0;  // number of pixels that differ by more than 1/255 in a channel
    int worst = 0;
    size_t first = 0;
};

Difference compare(const ByteImage& a, const ByteImage& b) {
    Difference d;
    for (size_t i = 0; i < a.pixels.size(); i += 4) {
        int largest = 0;
        for (size_t k = 0; k < 4; ++k) largest = std::max(largest, std::abs(int(a.pixels[i + k]) - int(b.pixels[i + k])));
        if (largest > 1 && d.pixels++ == 0) d.first = i / 4;
        d.worst = std::max(d.worst, largest);
    }
    return d;
}

void expect_same_pictures(const std::string& name, const std::vector<Configuration>& configurations, int width, int height) {
    const ScenePtr scene = load_scene(source_file(name));
    const View view = make_view(*scene, float(width) / height);
    Settings settings;
    settings.width = width;
    settings.height = height;
    settings.depth = 6;
    Configuration{"bvh2", 1, 1, 1}.apply(settings);
    FrameStats stats, reference_stats;
    const ByteImage reference = bench().display(scene, settings, view, &reference_stats);
    EXPECT_GT(reference_stats.secondary, size_t(width) * height / 20) << "too few reflections to prove anything";
    for (const Configuration& configuration : configurations) {
        configuration.apply(settings);
        const Difference d = compare(reference, bench().display(scene, settings, view, &stats));
        EXPECT_EQ(d.pixels, 0u) << name << ", " << configuration.text() << ": worst " << d.worst << "/255, first at "
                                << d.first % width << "," << d.first / width;
        EXPECT_EQ(stats.dropped, 0u) << configuration.text();
        EXPECT_NEAR(double(stats.secondary), double(reference_stats.secondary), 1e-3 * reference_stats.secondary)
            << configuration.text();
        EXPECT_NEAR(double(stats.shadow), double(reference_stats.shadow), 1e-3 * reference_stats.shadow)
            << configuration.text();
    }
}

TEST(Independence, EveryPrimitiveMaterialAndLight) {
    expect_same_pictures("scenes/primitives.scene", all_pairs(bench().accels()), 240, 180);
}

TEST(Independence, TexturedShowpiece) {
    std::vector<Configuration> some;  // only some, because each compiles a large kernel
    int lanes = 4;
    for (const std::string& accel : bench().fast_accels()) {
        some.push_back({accel, lanes, 4, 4});
        lanes = lanes == 16 ? 8 : 16;
    }
    expect_same_pictures("scenes/showpiece.scene", some, 240, 180);
}

// Packets of camera rays that see nothing of the scene are filled without tracing. The test makes sure that no object at the
// edge of a packet is lost.
TEST(Independence, ObjectsAtTheEdgeOfAPacket) {
    auto bounded = std::make_shared<Scene>(*geometry_of(load_scene(source_file("scenes/primitives.scene"))));
    bounded->planes.clear();  // planes are visible nearly everywhere
    const ScenePtr scene = bounded;
    const Bounds box = scene->bounds();
    const std::array<float, 3> middle = {(box.min[0] + box.max[0]) / 2, (box.min[1] + box.max[1]) / 2,
                                         (box.min[2] + box.max[2]) / 2};
    const float size = box.diagonal();
    std::mt19937 random(21);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> any(0, 1);
    Settings one = make_settings({{"size", "190x150"}, {"depth", "1"}}), many = one;
    Configuration{"bvh8", 1, 1, 1}.apply(one);
    Configuration{"bvh8", 16, 16, 16}.apply(many);
    size_t seen = 0, empty = 0;
    for (int i = 0; i < 60; ++i) {
        View view = make_view(*scene, float(one.width) / one.height);
        // The camera is inside, near or far. It looks at the scene, past it or away from it, sometimes along an axis.
        const float distance = size * std::pow(10.0f, 3 * any(random) - 1.5f);
        std::array<float, 3> away{normal(random), normal(random), normal(random)};
        if (i % 4 == 0) away = {i % 8 ? 0.0f : 1.0f, i % 8 ? 1.0f : 0.0f, 0.0f};
        const float length = std::hypot(away[0], away[1], away[2]);
        for (int k = 0; k < 3; ++k) {
            view.camera.eye[k] = middle[k] + distance / length * away[k];
            view.camera.target[k] = middle[k] + (i % 3 == 0 ? 0 : 0.7f * std::min(distance, 3 * size)) * normal(random);
        }
        view.camera.fov_y_rad = 0.02f + 2.5f * any(random) * any(random);
        const auto distances = [&](const Settings& settings) {
            bench().trace(scene, settings, view);
            return bench().frames().read_distance();
        };
        const FloatImage alone = distances(one), together = distances(many);
        ASSERT_EQ(alone.pixels.size(), together.pixels.size());
        size_t different = 0;
        for (size_t p = 0; p < alone.pixels.size(); ++p) {
            different += std::isfinite(alone.pixels[p]) != std::isfinite(together.pixels[p]);
            ++(std::isfinite(alone.pixels[p]) ? seen : empty);
        }
        EXPECT_EQ(different, 0u) << "view " << i << ": pixels in which only one of them sees anything";
    }
    EXPECT_GT(seen, 100000u);
    EXPECT_GT(empty, 100000u);
}

// Picture sizes that are no multiple of a packet, down to a single pixel.
TEST(Independence, OddSizes) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    for (const auto& [width, height] : std::vector<std::pair<int, int>>{{1, 1}, {17, 3}, {3, 17}, {33, 31}}) {
        const View view = make_view(*scene, float(width) / height);
        Settings settings;
        settings.width = width;
        settings.height = height;
        Configuration{"bvh2", 1, 1, 1}.apply(settings);
        const ByteImage reference = bench().display(scene, settings, view);
        for (const Configuration& configuration : all_pairs({"bvh2"})) {
            configuration.apply(settings);
            const ByteImage image = bench().display(scene, settings, view);
            ASSERT_EQ(image.pixels.size(), size_t(4) * width * height);
            EXPECT_EQ(compare(reference, image).pixels, 0u) << width << "x" << height << ", " << configuration.text();
        }
    }
}

// Samples of a picture are numbered, so it does not matter how they are divided among frames.
TEST(Independence, SamplesDependOnTheirIndexOnly) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const View view = make_view(*scene, 4.0f / 3);
    const auto device = std::make_shared<Device>(choose_device(""));
    Preparer preparer(bench().plugins(), device);
    Progress progress;
    const auto picture = [&](const Configuration& configuration, unsigned samples) {
        Settings settings = make_settings({{"size", "80x60"}});
        configuration.apply(settings);
        FrameRenderer frames(device);
        const auto prepared = preparer.prepare(scene, settings, progress);
        for (unsigned sample = 0; sample < samples; ++sample) frames.trace(*prepared, settings, view, sample, false, progress);
        return frames.read_display(settings);
    };
    const ByteImage one = picture({"bvh2", 1, 1, 1}, 1), eight = picture({"bvh2", 1, 1, 1}, 8),
                    packets = picture({"spheres", 16, 8, 8}, 8);
    EXPECT_EQ(compare(eight, packets).pixels, 0u);
    EXPECT_GT(compare(one, eight).pixels, 100u) << "more samples change nothing: edges should be smoother";
}

}  // namespace
