#include "scene/material_text.hpp"

#include <cstring>

#include "base/numbers.hpp"
#include "base/printable.hpp"
#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"

namespace clarity {
namespace {

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
