#include "view/edit/texture_edit.hpp"

#include <algorithm>
#include <filesystem>

#include "scene/map_uses.hpp"
#include "view/edit/edit.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

rt_u32 map_use_of(const std::string& key) {
    return key.rfind("material.", 0) == 0 ? find_map_use(key.substr(key.find_last_of('.') + 1)) : RT_NONE;
}

std::string map_names() {
    std::string names;
    for (const MapUse& use : map_uses()) names += (names.empty() ? "" : ", ") + std::string(use.name);
    return names;
}

rt_u32 read_texture(const Scene& scene, rt_u32 use, const std::string& key, const std::string& value) {
    if (value == "none") return RT_NONE;
    const rt_u32 texture = find_texture(scene, value, use);
    if (texture != RT_NONE) return texture;
    std::string names;
    constexpr size_t kMostListed = 20;
    for (size_t i = 0; i < std::min(scene.textures.size(), kMostListed); ++i)
        names += ", " + texture_name(scene, static_cast<rt_u32>(i));
    if (scene.textures.size() > kMostListed) names += ", ...";
    refuse_value(key, value,
                 "none, a picture's file that can be read, or a texture of the scene" +
                     (names.empty() ? " (it has none)" : ":" + names.substr(1)));
}

void add_map_words(const Scene& scene, const MapEdits& from, const MapEdits& to, std::vector<Word>& words) {
    const auto add = [&](rt_u32 material, rt_u32 use) {
        const rt_u32 was = from.texture_of(scene, material, use), is = to.texture_of(scene, material, use);
        if (was != is)
            words.push_back(
                {"material." + std::to_string(material) + "." + map_uses()[use].name, texture_word(scene, is, use)});
    };
    for (const MapEdits::Given& given : to.given) add(given.material, given.use);
    for (const MapEdits::Given& given : from.given)
        if (to.texture_of(scene, given.material, given.use) == MapEdits().texture_of(scene, given.material, given.use))
            add(given.material, given.use);
}

PictureFile picture_of(const Word& word) {
    const rt_u32 use = map_use_of(word.key);
    std::error_code error;
    if (use == RT_NONE || word.value == "none" || !std::filesystem::is_regular_file(word.value, error)) return {};
    return {word.value, map_uses()[use].space};
}

std::vector<PictureFile> pictures_of(const std::vector<Word>& edits) {
    std::vector<PictureFile> pictures;
    for (const Word& word : edits) {
        PictureFile picture = picture_of(word);
        if (!picture.path.empty() && std::find(pictures.begin(), pictures.end(), picture) == pictures.end())
            pictures.push_back(std::move(picture));
    }
    return pictures;
}

}  // namespace clarity
