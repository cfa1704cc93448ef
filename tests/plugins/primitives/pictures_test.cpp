// Pictures of shapes are compared with those of fine meshes.
#include <gtest/gtest.h>

#include <cmath>

#include "reference.hpp"
#include "view/view.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr unsigned kSize = 128, kFine = 256;  // kFine: for outlines

// A view of a placed shape from one of its sides, with a light at the eye, so that nothing visible is in shadow.
View view_of(const PlacedShape& placed, int side) {
    const double r = 4 * placed.shape->reach;
    const Vec eyes[] = {{0.6 * r, 0.5 * r, 0.6 * r}, {-0.7 * r, 0.6 * r, 0.2 * r}, {0.3 * r, -0.8 * r, -0.4 * r}};
    const Vec eye = transformed(placed.world, eyes[side]), target = transformed(placed.world, {0, 0, 0});
    const auto point = [](const Vec& v) { return Point{float(v[0]), float(v[1]), float(v[2])}; };
    View view = view_from(point(eye), point(target), 32);
    rt_light light{};
    light.kind = RT_LIGHT_POINT;
    for (size_t k = 0; k < 3; ++k) {
        light.position[k] = static_cast<float>(eye[k]);
        light.color[k] = 1;
    }
    view.lights = {light};
    view.materials = {diffuse(1, 1, 1)};
    view.background = {0, 0, 0};
    view.ambient = {0, 0, 0};
    return view;
}

std::vector<float> picture(const ScenePtr& scene, const View& view, const char* aov, unsigned width = kSize) {
    const std::string size = std::to_string(width) + "x" + std::to_string(width);
    const FloatImage image = Workbench::get().values(
        scene, make_settings({{"accel", "bvh2"}, {"lanes", "8"}, {"size", size}, {"aov", aov}, {"depth", "1"}}), view);
    std::vector<float> first;
    for (size_t i = 0; i < image.pixels.size(); i += image.channels) first.push_back(image.pixels[i]);
    return first;
}

// Whether a pixel of `found` agrees with the same one of `expected`, or with a neighbour.
template <class Agree>
bool agrees_within_a_pixel(const std::vector<float>& found, const std::vector<float>& expected, int x, int y,
                           const Agree& agree) {
    const int size = kSize;
    const float value = found[static_cast<size_t>(y * size + x)];
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, size - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, size - 1); ++u)
            if (agree(value, expected[static_cast<size_t>(v * size + u)])) return true;
    return false;
}

class ShapePictures : public ::testing::TestWithParam<size_t> {
 protected:
    static ScenePtr mesh() {
        static const ScenePtr scene = fine_mesh();
        return scene;
    }
};

TEST_P(ShapePictures, SilhouettesAreThoseOfTheMesh) {
    const PlacedShape& placed = placed_shapes()[GetParam()];
    for (const int side : {0, 1}) {
        SCOPED_TRACE(placed.shape->name + ", side " + std::to_string(side));
        const View view = view_of(placed, side);
        const std::vector<float> found = picture(imported_shapes(), view, "t"), expected = picture(mesh(), view, "t");
        const auto near = [](float a, float b) { return a == b || std::fabs(a - b) <= 0.01f * b; };
        size_t hits = 0, wrong = 0, missed = 0;
        for (int y = 0; y < int(kSize); ++y)
            for (int x = 0; x < int(kSize); ++x) {
                hits += std::isfinite(found[static_cast<size_t>(y) * kSize + static_cast<size_t>(x)]);
                wrong += !agrees_within_a_pixel(found, expected, x, y, near);
                missed += !agrees_within_a_pixel(expected, found, x, y, near);
            }
        EXPECT_GT(hits, 200u);
        EXPECT_EQ(wrong, 0u) << "pixels of the shape";
        EXPECT_EQ(missed, 0u) << "pixels of the mesh";
    }
}

// Whether hit and miss meet at this pixel or one of its neighbours.
bool is_beside_edge(const std::vector<float>& picture, int x, int y) {
    const int size = kFine;
    const bool hit = std::isfinite(picture[static_cast<size_t>(y * size + x)]);
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, size - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, size - 1); ++u)
            if (std::isfinite(picture[static_cast<size_t>(v * size + u)]) != hit) return true;
    return false;
}

// Where shape and mesh disagree about hit and miss, both have an edge within a pixel.
TEST_P(ShapePictures, OutlinesAreWithinAPixelOfTheMesh) {
    const PlacedShape& placed = placed_shapes()[GetParam()];
    for (const int side : {0, 1, 2}) {
        SCOPED_TRACE(placed.shape->name + ", side " + std::to_string(side));
        const View view = view_of(placed, side);
        const std::vector<float> found = picture(imported_shapes(), view, "t", kFine),
                                 expected = picture(mesh(), view, "t", kFine);
        size_t differing = 0, wrong = 0, edge = 0;
        for (int y = 0; y < int(kFine); ++y)
            for (int x = 0; x < int(kFine); ++x) {
                const size_t i = static_cast<size_t>(y) * kFine + static_cast<size_t>(x);
                const bool beside = is_beside_edge(expected, x, y);
                edge += beside;
                if (std::isfinite(found[i]) == std::isfinite(expected[i])) continue;
                ++differing;
                wrong += !beside || !is_beside_edge(found, x, y);
            }
        EXPECT_GT(edge, 100u);
        EXPECT_LT(differing, edge / 4) << "most of the outline is the same";
        EXPECT_EQ(wrong, 0u) << "of " << differing << " pixels that only one of them hits";
    }
}

// Light comes from the eye: what the shape hides from it by rounding would be black, and a wrong normal is brighter or darker.
TEST_P(ShapePictures, IsLitAsTheMesh) {
    const PlacedShape& placed = placed_shapes()[GetParam()];
    for (const int side : {0, 1}) {
        SCOPED_TRACE(placed.shape->name + ", side " + std::to_string(side));
        const View view = view_of(placed, side);
        const std::vector<float> found = picture(imported_shapes(), view, "color"), expected = picture(mesh(), view, "color");
        const auto near = [](float a, float b) { return std::fabs(a - b) <= 0.05f; };
        size_t wrong = 0, lit = 0;
        for (int y = 0; y < int(kSize); ++y)
            for (int x = 0; x < int(kSize); ++x) {
                lit += found[static_cast<size_t>(y) * kSize + static_cast<size_t>(x)] > 0.1f;
                wrong += !agrees_within_a_pixel(found, expected, x, y, near);
            }
        EXPECT_GT(lit, 150u);
        EXPECT_LE(wrong, lit / 100);
    }
}

INSTANTIATE_TEST_SUITE_P(All, ShapePictures, testing::Range(size_t{0}, size_t{14}));

TEST(ShapePicturesCount, AllAreTested) {
    EXPECT_EQ(placed_shapes().size(), 14u) << "write the number into the line above";
}

}  // namespace
