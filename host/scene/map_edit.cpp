#include "scene/map_edit.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "base/numbers.hpp"
#include "scene/bright_texture.hpp"
#include "scene/map_uses.hpp"
#include "scene/tangents.hpp"

namespace clarity {
namespace {

template <class List>
auto given_at(List& given, rt_u32 material, rt_u32 use) {
    return std::lower_bound(given.begin(), given.end(), std::make_pair(material, use),
                            [](const MapEdits::Given& g, const auto& key) { return std::make_pair(g.material, g.use) < key; });
}

rt_u32 own_texture(const Scene& scene, rt_u32 material, rt_u32 use) {
    const Material& m = scene.materials[material];
    if (m.maps[use] != RT_NONE) return scene.maps[m.maps[use]].texture;
    return use == RT_MAP_COLOR ? m.values.texture : RT_NONE;
}

// Bright pictures are linear for every use.
bool is_of_space(const rt_texture& texture, rt_u32 space) {
    return is_bright(texture) || ((texture.flags & RT_TEXTURE_LINEAR) != 0) == (space != RT_SPACE_SRGB);
}

// The picture in a colour space: itself, or another texture of the same texels.
rt_u32 in_space(Scene& scene, rt_u32 texture, rt_u32 space) {
    rt_texture wanted = scene.textures[texture];
    if (is_of_space(wanted, space)) return texture;
    wanted.flags ^= RT_TEXTURE_LINEAR;
    for (size_t i = 0; i < scene.textures.size(); ++i)
        if (std::memcmp(&scene.textures[i], &wanted, sizeof wanted) == 0) return static_cast<rt_u32>(i);
    scene.texture_names.resize(scene.textures.size());
    scene.texture_names.push_back(scene.texture_names[texture]);
    scene.textures.push_back(wanted);
    return static_cast<rt_u32>(scene.textures.size() - 1);
}

// How the texture of a use lies on the surface.
rt_map placing(const Scene& scene, const Material& material, rt_u32 use) {
    for (const rt_u32 of : {use, rt_u32(RT_MAP_COLOR)})
        if (material.maps[of] != RT_NONE) {
            rt_map map = scene.maps[material.maps[of]];
            if (of != use) map.scale = 1;
            return map;
        }
    rt_map map{};
    map.matrix[0] = map.matrix[4] = map.scale = 1;
    return map;
}

template <class T>
bool same_list(const std::vector<T>& a, const std::vector<T>& b) {
    static_assert(std::is_trivially_copyable_v<T>, "compared byte by byte");
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_place(const Instance& a, const Instance& b) {
    return a.mesh == b.mesh && a.material == b.material && a.world_from_object == b.world_from_object &&
           a.visible == b.visible && a.apart == b.apart && a.mask == b.mask;
}

}  // namespace

rt_u32 MapEdits::texture_of(const Scene& scene, rt_u32 material, rt_u32 use) const {
    const auto at = given_at(given, material, use);
    const bool is = at != given.end() && at->material == material && at->use == use;
    return is ? at->texture : own_texture(scene, material, use);
}

void MapEdits::give(const Scene& scene, rt_u32 material, rt_u32 use, rt_u32 texture) {
    const auto at = given_at(given, material, use);
    const bool is = at != given.end() && at->material == material && at->use == use,
               does_nothing = texture == own_texture(scene, material, use);
    if (is && does_nothing)
        given.erase(at);
    else if (is)
        at->texture = texture;
    else if (!does_nothing)
        given.insert(at, {material, use, texture});
}

void MapEdits::reset(rt_u32 material) {
    given.erase(std::remove_if(given.begin(), given.end(), [&](const Given& g) { return g.material == material; }),
                given.end());
}

Scene with_maps(const Scene& scene, const MapEdits& edits) {
    Scene result = scene;
    for (const MapEdits::Given& edit : edits.given) {
        if (edit.material >= result.materials.size()) continue;
        Material& material = result.materials[edit.material];
        // From the scene itself: the colour of a material may have been edited before its other uses.
        rt_map map = placing(scene, scene.materials[edit.material], edit.use);
        material.maps[edit.use] = RT_NONE;
        if (edit.use == RT_MAP_COLOR) material.values.texture = RT_NONE;
        if (edit.texture >= result.textures.size()) continue;
        map.texture = in_space(result, edit.texture, map_uses()[edit.use].space);
        if (edit.use == RT_MAP_COLOR && map.set == 0 && lies_plainly(map)) {
            material.values.texture = map.texture;
            continue;
        }
        material.maps[edit.use] = static_cast<rt_u32>(result.maps.size());
        result.maps.push_back(map);
    }
    make_tangents(result);
    return result;
}

bool same_geometry(const Scene& a, const Scene& b) {
    return a.positions.shares(b.positions) && a.triangles.shares(b.triangles) &&
           a.triangle_materials.shares(b.triangle_materials) && a.normals.shares(b.normals) &&
           a.has_attributes() == b.has_attributes() && a.meshes.size() == b.meshes.size() &&
           std::equal(a.instances.begin(), a.instances.end(), b.instances.begin(), b.instances.end(), same_place) &&
           same_list(a.spheres, b.spheres) && same_list(a.planes, b.planes) && same_list(a.polygons, b.polygons) &&
           same_list(a.polygon_corners, b.polygon_corners) && same_list(a.shapes, b.shapes) &&
           same_list(a.shape_parts, b.shape_parts) && same_list(a.shape_numbers, b.shape_numbers);
}

rt_u32 find_texture(const Scene& scene, const std::string& text, rt_u32 use) {
    rt_u32 found = RT_NONE;
    const auto look_for = [&](const std::string& name) {
        for (size_t i = 0; i < std::min(scene.textures.size(), scene.texture_names.size()); ++i) {
            if (name.empty() || scene.texture_names[i] != name) continue;
            const bool fits = is_of_space(scene.textures[i], map_uses()[use].space);
            if (found == RT_NONE || fits) found = static_cast<rt_u32>(i);
            if (fits) return;
        }
    };
    look_for(text);
    if (found == RT_NONE) look_for(picture_name(text));
    rt_u32 number = 0;
    if (found == RT_NONE && read_number(text, number) && number < scene.textures.size()) found = number;
    return found;
}

std::string texture_word(const Scene& scene, rt_u32 texture, rt_u32 use) {
    if (texture == RT_NONE) return "none";
    const std::string name = texture < scene.texture_names.size() ? scene.texture_names[texture] : "";
    const bool is_found = !name.empty() && name != "none" && find_texture(scene, name, use) == texture;
    return is_found ? name : std::to_string(texture);
}

std::string picture_name(const std::string& path) {
    std::error_code error;
    const std::filesystem::path whole = std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
    return error ? path : whole.string();
}

}  // namespace clarity
