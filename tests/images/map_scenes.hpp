// map_scenes.hpp -- a square and a lamp whose materials have textures, and what is seen of them.
#pragma once
#include <gtest/gtest.h>

#include "images/optics.hpp"
#include "images/path_checks.hpp"

namespace clarity::test {

using Texels = std::vector<uint32_t>;
inline constexpr uint32_t kRed = 0xff0000ffu, kGreen = 0xff00ff00u, kBlue = 0xffff0000u, kWhite = 0xffffffffu,
                          kBlack = 0xff000000u;

inline rt_u32 add_texture(Scene& scene, rt_u32 width, const Texels& texels, rt_u32 flags = 0) {
    const auto first = static_cast<rt_u32>(scene.texels.size());
    const rt_u32 height = static_cast<rt_u32>(texels.size()) / width;
    scene.texels.append(texels.begin(), texels.end());
    scene.textures.push_back({first, width, height, 0, flags, 0, 0});
    return static_cast<rt_u32>(scene.textures.size() - 1);
}

inline rt_map& add_map(Scene& scene, rt_u32 material, rt_u32 use, rt_u32 texture, rt_u32 set = 0) {
    scene.materials[material].maps[use] = static_cast<rt_u32>(scene.maps.size());
    scene.maps.push_back({{1, 0, 0, 0, 1, 0}, texture, set, 1, 0});
    return scene.maps.back();
}

inline View flat_view() {
    View view = view_of_square();
    view.background = {1, 1, 1};
    return view;
}

// The pictures of Whitted's tracers and of `path`, which are alike.
inline std::vector<FloatImage> pictures(const Scene& scene, const View& view = flat_view()) {
    return {trace(scene, view, 64, 64, 1, {{"lanes", "8"}}).image, trace_paths(scene, view, 16, {{"strategy", "bsdf"}}).mean};
}

inline std::array<float, 3> pixel(const FloatImage& image, int x, int y) {
    const float* const p = &image.pixels[3 * (size_t(y) * image.width + x)];
    return {p[0], p[1], p[2]};
}

inline void expect_color(const FloatImage& image, int x, int y, const std::array<float, 3>& wanted, double room,
                         const char* what) {
    const auto seen = pixel(image, x, y);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], wanted[k], room) << what << " at " << x << "," << y << ", channel " << k;
}

// A floor, and above it a lamp that faces it, 2 x 2, with its own coordinates.
inline Scene lamp(const Texels& texels, rt_u32 flags = RT_TEXTURE_NEAREST) {
    TriangleMesh mesh;
    mesh.add_quad(Vec{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1});
    mesh.add_quad(Vec{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9});
    Scene scene = scene_of(mesh);
    scene.uvs = {0, 0, 1, 0, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0};
    scene.materials[0].values = diffuse(0, 0, 0);
    for (float& channel : scene.materials[0].values.emission) channel = 2;
    scene.triangle_materials.own() = {0, 0, add_material(scene, diffuse(0.8f, 0.8f, 0.8f)), 1};
    if (!texels.empty()) add_map(scene, 0, RT_MAP_EMISSION, add_texture(scene, 2, texels, flags));
    return scene;
}
inline PathPicture lit_floor(const Scene& scene, const char* strategy) {
    View view = view_from({0, 0.5f, 0}, {0, 0, 0}, 20);
    view.camera.up = {0, 0, 1};
    view.background = {0, 0, 0};
    return trace_paths(scene, view, 64, {{"strategy", strategy}, {"depth", "1"}, {"sampler", "independent"}});
}

}  // namespace clarity::test
