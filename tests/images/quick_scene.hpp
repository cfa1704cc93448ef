// quick_scene.hpp -- for quick tests: makes scenes with textures share one program of kernels.
#pragma once
#include <algorithm>

#include "scene/bright_texture.hpp"
#include "support/generated.hpp"

namespace clarity::test {

// For quick tests: gives a scene with textures all that textures can have, on a material that nothing has, so that kernels are
// the same for all such scenes. Unchanged: scenes without textures, views that list the scene's materials, and the long form.
inline Scene with_all_of_textures(Scene scene, const View& view) {
    const bool has_textures = std::any_of(scene.materials.begin(), scene.materials.end(),
                                          [](const Material& m) { return m.values.texture != RT_NONE || m.maps != no_maps(); });
    if (!few_ways() || !has_textures || !view.materials.empty() || scene.uvs.empty()) return scene;
    if (scene.uvs2.empty()) scene.uvs2 = scene.uvs;
    if (scene.tangents.empty()) scene.tangents.own().assign(3 * size_t(scene.triangle_count()), 0);  // 0: the triangle has none
    const auto first = static_cast<rt_u32>(scene.texels.size());
    for (int i = 0; i < 5; ++i) scene.texels.push_back(0);
    scene.textures.push_back({first, 2, 2, RT_WRAP_CLAMP, kBrightTexture, 1, 0});
    scene.maps.push_back({{1, 0, 0, 0, 1, 0}, static_cast<rt_u32>(scene.textures.size() - 1), 0, 1, 0});
    scene.materials.push_back({"", diffuse(1, 1, 1)});
    scene.materials.back().maps[RT_MAP_COLOR] = static_cast<rt_u32>(scene.maps.size() - 1);
    return scene;
}

}  // namespace clarity::test
