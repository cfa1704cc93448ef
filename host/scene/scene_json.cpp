#include "scene/scene_json.hpp"

#include <algorithm>
#include <cstring>

#include "base/numbers.hpp"
#include "base/text.hpp"
#include "scene/emissive.hpp"
#include "scene/light_kinds.hpp"
#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"

namespace clarity {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const std::array<float, 3>& v) {
    return {short_double(v[0]), short_double(v[1]), short_double(v[2])};
}

// A point of the scene in the coordinates of its files.
Json point_json(const std::array<float, 3>& p, const Scene& scene) {
    if (scene.origin == std::array<double, 3>{}) return vector_json(p);
    return {p[0] + scene.origin[0], p[1] + scene.origin[1], p[2] + scene.origin[2]};
}

Json camera_json(const Camera& camera, const Scene& scene) {
    Json json = {{"name", camera.name},
                 {"eye", point_json(camera.eye, scene)},
                 {"target", point_json(camera.target, scene)},
                 {"up", vector_json(camera.up)},
                 {"fov_deg", short_double(camera.fov_y_rad * 57.29578f)}};
    if (camera.aperture > 0) json["aperture"] = short_double(camera.aperture), json["focus"] = short_double(camera.focus);
    return json;
}

Json clip_json(const ClipInfo& clip) {
    return {{"name", clip.name},    {"begin_s", clip.begin_s},
            {"end_s", clip.end_s},  {"fps", clip.fps > 0 ? Json(clip.fps) : Json()},
            {"nodes", clip.nodes},  {"skins", clip.skins},
            {"morphs", clip.morphs}};
}

// Calls tell(key, value) for each value of the model that is no default. What only Whitted's tracers read follows other models.
template <class Tell>
void each_value(const MaterialValues& values, const Tell& tell) {
    for (const Key& key : material_keys()) {
        const std::array<float, 3> value = value_of(key, &values);
        const bool follows = key.follows_model && values.model != RT_MODEL_WHITTED;
        const bool is_model = std::strcmp(key.name, "model") == 0;
        if (!key.alias && !follows && !is_model && has_key(values.model, key) && value != key.def) tell(key, value);
    }
}

// What its importer did not understand of it: importers have one warning for each such material.
std::string left_out_of(const Scene& scene, const Material& material) {
    const std::string begin = "material '" + material.name + "': left out ";
    for (const std::string& warning : scene.warnings)
        if (const size_t at = warning.find(begin); at != std::string::npos) return warning.substr(at + begin.size());
    return {};
}

std::string model_of(const MaterialValues& values) {
    const Key& model = material_key("model");
    return value_text(model, value_of(model, &values), " ");
}

}  // namespace

uint64_t face_count(const Scene& scene) {
    uint64_t count = 0;
    for (const Instance& instance : scene.instances) count += scene.meshes[instance.mesh].polygon_count;
    return count;
}

std::map<std::string, uint64_t> shape_counts(const Scene& scene) {
    std::map<std::string, uint64_t> counts;
    for (const Shape& shape : scene.shapes) ++counts[scene.shape_kinds[shape.kind].id];
    return counts;
}

std::map<std::string, uint64_t> light_counts(const Scene& scene) {
    std::map<std::string, uint64_t> counts;
    for (const Light& light : scene.lights) ++counts[light_kind_of(light.values).name];
    return counts;
}

std::string sky_text(const Sky& sky) {
    switch (sky.values.kind) {
        case RT_SKY_CONSTANT:
            return "constant";
        case RT_SKY_GRADIENT:
            return "gradient";
        case RT_SKY_PICTURE:
            return sky.file + ", " + std::to_string(sky.values.width) + " x " + std::to_string(sky.values.height);
    }
    return "background";
}

uint64_t materials_with_alpha(const Scene& scene) {
    return static_cast<uint64_t>(std::count_if(scene.materials.begin(), scene.materials.end(),
                                               [](const Material& m) { return m.values.alpha != RT_ALPHA_OPAQUE; }));
}

nlohmann::ordered_json scene_json(const Scene& scene, const std::vector<ClipInfo>& animations,
                                  const std::vector<std::string>& files) {
    Json json;
    json["files"] = files;
    json["meshes"] = scene.meshes.size();
    json["instances"] = scene.instances.size();
    json["triangles"] = scene.placed_triangle_count();
    json["unique_triangles"] = scene.triangle_count();
    json["vertices"] = scene.vertex_count();
    json["vertex_colors"] = !scene.colors.empty();
    json["faces"] = face_count(scene);
    json["polygons"] = scene.polygons.size();
    json["spheres"] = scene.spheres.size();
    json["planes"] = scene.planes.size();
    json["shapes"] = Json::object();
    for (const auto& [id, count] : shape_counts(scene)) json["shapes"][id] = count;
    json["materials"] = scene.materials.size();
    json["materials_with_alpha"] = materials_with_alpha(scene);
    json["textures"] = scene.textures.size();
    json["texture_bytes"] = scene.texels.size() * sizeof(uint32_t);
    json["lights"] = scene.lights.size();
    json["light_kinds"] = Json::object();
    for (const auto& [kind, count] : light_counts(scene)) json["light_kinds"][kind] = count;
    const EmissiveCounts emissive = count_emissive(scene);
    json["emissive"] = {
        {"triangles", emissive.triangles},           {"spheres", emissive.spheres}, {"polygons", emissive.polygons},
        {"by_rays_alone", emissive.by_rays_alone()}, {"planes", emissive.planes},   {"shapes", emissive.shapes},
        {"bent_polygons", emissive.bent_polygons},   {"cut_out", emissive.cut_out}};
    json["sky"] = sky_text(scene.sky);
    json["cameras"] = scene.cameras.size();
    const Bounds bounds = scene.bounds();
    json["bounds"] =
        bounds.empty ? Json() : Json{{"min", point_json(bounds.min, scene)}, {"max", point_json(bounds.max, scene)}};
    if (scene.origin != std::array<double, 3>{}) json["origin"] = scene.origin;
    json["surface_area"] = scene.surface_area();
    json["up_axis"] = std::string(1, "xyz"[scene.up_axis % 3]);
    json["unit_scale"] = scene.unit_scale > 0 ? Json(scene.unit_scale) : Json();
    json["camera_list"] = Json::array();
    for (const Camera& camera : scene.cameras) json["camera_list"].push_back(camera_json(camera, scene));
    json["material_list"] = Json::array();
    for (const Material& material : scene.materials) json["material_list"].push_back(material_json(scene, material));
    json["animations"] = Json::array();
    for (const ClipInfo& clip : animations) json["animations"].push_back(clip_json(clip));
    json["warnings"] = scene.warnings;
    return json;
}

nlohmann::ordered_json material_json(const Scene& scene, const Material& material) {
    nlohmann::ordered_json json = {{"name", material.name}, {"model", model_of(material.values)}};
    each_value(material.values, [&](const Key& key, const std::array<float, 3>& value) {
        if (key.kind == RT_KEY_FLAG)
            json[key.name] = value[0] != 0;
        else if (key.kind == RT_KEY_WORD)
            json[key.name] = value_text(key, value, " ");
        else if (count_of(key) == 1)
            json[key.name] = short_double(value[0]);
        else
            json[key.name] = {short_double(value[0]), short_double(value[1]), short_double(value[2])};
    });
    if (material.values.texture != RT_NONE) json["texture"] = material.values.texture;
    each_map(scene, material, [&](const MapUse& use, const rt_map& map) {
        json[use.name] = {{"texture", map.texture}, {"name", texture_name(scene, map.texture)}, {"uv", map.set}};
        if (map.scale != 1) json[use.name]["strength"] = short_double(map.scale);
        if (!lies_plainly(map))
            for (const float number : map.matrix) json[use.name]["matrix"].push_back(short_double(number));
    });
    if (const std::string left_out = left_out_of(scene, material); !left_out.empty()) json["left_out"] = left_out;
    return json;
}

std::string material_text(const Scene& scene, const Material& material) {
    std::string text = (material.name.empty() ? "(no name)" : printable_line(material.name)) + ": " + model_of(material.values);
    each_value(material.values, [&](const Key& key, const std::array<float, 3>& value) {
        text += std::string(", ") + key.name + ' ' + value_text(key, value, " ");
    });
    const auto named = [&](rt_u32 texture) { return " " + printable_line(texture_name(scene, texture)); };
    if (material.values.texture != RT_NONE) text += ", color_map" + named(material.values.texture);
    each_map(scene, material, [&](const MapUse& use, const rt_map& map) {
        text += std::string(", ") + use.name + named(map.texture);
        if (map.set != 0) text += " (uv " + std::to_string(map.set) + ")";
    });
    if (const std::string left_out = left_out_of(scene, material); !left_out.empty())
        text += "; left out: " + printable_line(left_out);
    return text;
}

}  // namespace clarity
