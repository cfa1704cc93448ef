// independence_test.cpp -- a picture is the same whatever structure, lane count, packet and tracer computed it.
#include <gtest/gtest.h>

#include <cstdlib>

#include "support/scenes.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

Workbench& bench() {
    return Workbench::get();
}

struct Difference {
    size_t pixels = 0;  // that differ by more than 1/255 in a channel
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
    std::vector<Configuration> some;  // each compiles a large kernel
    int lanes = 4;
    for (const std::string& accel : bench().fast_accels()) {
        some.push_back({accel, lanes, 4, 4});
        lanes = lanes == 16 ? 8 : 16;
    }
    expect_same_pictures("scenes/showpiece.scene", some, 240, 180);
}

// Sizes that no packet divides, down to a single pixel.
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

// The samples of a picture are numbered, so it does not matter how they are dealt out.
TEST(Independence, SamplesDependOnTheirNumberAlone) {
    const ScenePtr scene = load_scene(source_file("scenes/primitives.scene"));
    const View view = make_view(*scene, 4.0f / 3);
    const auto device = std::make_shared<Device>(choose_device(""));
    Preparer preparer(bench().plugins(), device);
    Progress progress;
    const auto picture = [&](const Configuration& configuration, unsigned samples) {
        Settings settings = make_settings({{"size", "80x60"}});
        configuration.apply(settings);
        Frames frames(device);
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
