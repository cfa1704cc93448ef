// scale_test.cpp -- a scene looks the same whatever its size, from 1e-9 to 1e9.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "support/scenes.hpp"
#include "support/scratch.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

// A dented ball of 1152 quads.
std::string ball(double scale) {
    constexpr int kRings = 24, kSegments = 48;
    std::string text;
    char line[128];
    for (int r = 0; r <= kRings; ++r)
        for (int s = 0; s < kSegments; ++s) {
            const double a = 3.14159265 * r / kRings, b = 2 * 3.14159265 * s / kSegments;
            std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n",
                          scale * std::sin(a) * std::cos(b) * (1 + 0.2 * std::sin(5 * b)), scale * std::cos(a),
                          scale * std::sin(a) * std::sin(b));
            text += line;
        }
    for (int r = 0; r < kRings; ++r)
        for (int s = 0; s < kSegments; ++s) {
            const int a = r * kSegments + s + 1, b = r * kSegments + (s + 1) % kSegments + 1;
            std::snprintf(line, sizeof line, "f %d %d %d %d\n", a, b, b + kSegments, a + kSegments);
            text += line;
        }
    return text;
}

TEST(Scale, PicturesAreAlikeFrom1em9To1e9) {
    const Scratch scratch;
    Settings settings;
    settings.width = settings.height = 96;
    Configuration{"bvh2", 4, 4, 4}.apply(settings);
    const auto picture = [&](double scale) {
        const ScenePtr scene = load_scene(scratch.write("ball_" + std::to_string(scale * 1e9) + ".obj", ball(scale)));
        char camera[96];
        std::snprintf(camera, sizeof camera, "%.9g,%.9g,%.9g,0,0,0,45", scale, 1.5 * scale, 3 * scale);
        return Workbench::get().display(scene, settings, make_view(*scene, 1, camera));
    };
    const ByteImage usual = picture(1);
    for (const double scale : {1e-9, 1e-3, 1e3, 1e9}) {
        const ByteImage other = picture(scale);
        int differing = 0;
        for (size_t i = 0; i < usual.pixels.size(); ++i) differing += std::abs(int(usual.pixels[i]) - int(other.pixels[i])) > 1;
        EXPECT_LE(differing, 12) << "at a scale of " << scale;  // a silhouette's pixels may go either way
    }
}

}  // namespace
