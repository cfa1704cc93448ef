// clarity plugins: lists every library seen, its plugins, and the reason if it was refused.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "base/text.hpp"
#include "cli/commands.hpp"
#include "plugin/capabilities.hpp"
#include "plugin/parameters.hpp"
#include "plugin/registry.hpp"
#include "rt_surface.h"

namespace clarity {
namespace {

using Json = nlohmann::ordered_json;

const char* kind_name(int32_t kind) {
    switch (kind) {
        case RT_PARAM_INT:
            return "int";
        case RT_PARAM_FLOAT:
            return "float";
        case RT_PARAM_BOOL:
            return "bool";
        default:
            return "enum";
    }
}

const char* effect_name(int32_t effect) {
    return effect == RT_EFFECT_RECOMPILE ? "recompile" : "rebuild";
}

const char* ray_cost_name(const rt_accel& accel) {
    return accel.ray_cost == RT_RAY_COST_LINEAR ? "linear" : "logarithmic";
}

const char* status_name(const PluginRecord& record) {
    return !record.plugin ? "refused" : record.shadowed ? "shadowed" : "loaded";
}

Json param_json(const rt_param& param) {
    Json json = {{"key", param.key},
                 {"label", param.label},
                 {"help", param.help},
                 {"kind", kind_name(param.kind)},
                 {"effect", effect_name(param.effect)}};
    switch (param.kind) {
        case RT_PARAM_BOOL:
            json["default"] = param.def != 0;
            break;
        case RT_PARAM_ENUM:
            for (const char* const* choice = param.choices; *choice; ++choice) json["choices"].push_back(*choice);
            json["default"] = param.choices[static_cast<size_t>(param.def)];
            break;
        case RT_PARAM_INT:
            json["min"] = static_cast<int64_t>(param.min);
            json["max"] = static_cast<int64_t>(param.max);
            json["default"] = static_cast<int64_t>(param.def);
            break;
        default:
            json["min"] = param.min;
            json["max"] = param.max;
            json["default"] = param.def;
    }
    return json;
}

const char* key_kind_name(const rt_key& key) {
    constexpr const char* names[] = {"number", "whole", "point", "vector", "numbers", "points"};
    return key.kind <= RT_KEY_POINTS ? names[key.kind] : "unknown";
}

Json keys_json(const rt_primitive& primitive) {
    Json list = Json::array();
    for (rt_u32 i = 0; i < primitive.key_count; ++i) {
        const rt_key& key = primitive.keys[i];
        list.push_back({{"key", key.name},
                        {"kind", key_kind_name(key)},
                        {"help", key.help},
                        {"required", (key.flags & RT_KEY_REQUIRED) != 0}});
    }
    return list;
}

// A number, or three of a colour.
Json keys_json(const rt_surface& surface) {
    Json list = Json::array();
    for (rt_u32 i = 0; i < surface.key_count; ++i) {
        const rt_surface_key& key = surface.keys[i];
        const bool is_color = key.kind == RT_KEY_COLOR;
        list.push_back({{"key", key.name},
                        {"label", key.label},
                        {"kind", is_color ? "color" : "number"},
                        {"help", key.help},
                        {"unit", key.unit ? Json(key.unit) : Json()},
                        {"min", key.min},
                        {"max", key.max},
                        {"default", is_color ? Json(key.def) : Json(key.def[0])}});
    }
    return list;
}

Json record_json(const PluginRecord& record) {
    Json json = {{"path", record.path}, {"status", status_name(record)}, {"replaced", record.replaced}};
    if (!record.plugin) {
        json["why"] = record.why;
        return json;
    }
    const rt_plugin& plugin = *record.plugin;
    json["kind"] = plugin_kind(plugin);
    json["id"] = plugin.id;
    json["name"] = plugin.name;
    json["version"] = plugin.version;
    json["reference"] = plugin.reference ? Json(plugin.reference) : Json();
    if (plugin.accel) {
        json["capabilities"] = Json::array();
        for (const std::string& name : capability_names(*plugin.accel)) json["capabilities"].push_back(name);
        json["merit"] = {{"cpu", plugin.accel->merit_cpu}, {"gpu", plugin.accel->merit_gpu}};
        json["ray_cost"] = ray_cost_name(*plugin.accel);
        if (plugin.accel->layout) {
            json["layout"] = plugin.accel->layout;
        } else {
            json["kernel_contract"] = plugin.accel->kernel_contract;
            json["packs_topologies"] = plugin.accel->pack != nullptr;
        }
    }
    if (plugin.importer) {
        json["extensions"] = Json::array();
        for (const char* const* e = plugin.importer->extensions; *e; ++e) json["extensions"].push_back(*e);
    }
    if (plugin.primitive) json["keys"] = keys_json(*plugin.primitive);
    if (const rt_surface* surface = rt_surface_of(&plugin)) json["keys"] = keys_json(*surface);
    json["abi_extensions"] = Json::array();
    for (const rt_extension* e = plugin.extensions; e && e->name; ++e)
        json["abi_extensions"].push_back({{"name", e->name}, {"version", e->version}});
    json["parameters"] = Json::array();
    for (rt_u32 i = 0; i < plugin.param_count; ++i) json["parameters"].push_back(param_json(plugin.params[i]));
    return json;
}

std::string range_text(const rt_param& param) {
    if (param.kind == RT_PARAM_BOOL) return "true, false";
    if (param.kind == RT_PARAM_ENUM) {
        std::string text;
        for (const char* const* choice = param.choices; *choice; ++choice)
            text += (text.empty() ? "" : ", ") + std::string(*choice);
        return text;
    }
    char text[64];
    std::snprintf(text, sizeof text, "%.9g to %.9g", param.min, param.max);
    return text;
}

constexpr const char* kIndent = "          ";

std::string merit_text(float merit, const char* kind) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", double(merit));
    return (merit > 0 ? std::string(text) : "not measured") + " on a " + kind;
}

void print_accel(const rt_accel& accel) {
    std::string can;
    for (const std::string& name : capability_names(accel)) can += (can.empty() ? "" : ", ") + name;
    if (!can.empty()) print_text("%scapabilities: %s\n", kIndent, can.c_str());
    if (accel.layout) print_text("%sbuilds a tree, which %s packs and traces\n", kIndent, accel.layout);
    if (accel.pack) print_text("%spacks trees that other plugins build\n", kIndent);
    print_text("%smerit: %s, %s; a ray's cost is %s\n", kIndent, merit_text(accel.merit_cpu, "CPU").c_str(),
               merit_text(accel.merit_gpu, "GPU").c_str(), ray_cost_name(accel));
}

// The keys of the shape's statement in text scenes.
void print_keys(const rt_primitive& primitive) {
    for (rt_u32 i = 0; i < primitive.key_count; ++i) {
        const rt_key& key = primitive.keys[i];
        std::string usual = "required";
        if (!(key.flags & RT_KEY_REQUIRED)) {
            char text[96] = "none";
            if (key.kind == RT_KEY_NUMBER || key.kind == RT_KEY_WHOLE) std::snprintf(text, sizeof text, "%g", key.def[0]);
            if (key.kind == RT_KEY_POINT || key.kind == RT_KEY_VECTOR)
                std::snprintf(text, sizeof text, "%g %g %g", key.def[0], key.def[1], key.def[2]);
            usual = std::string("default ") + text;
        }
        print_text("%s%-20s %s (%s; %s)\n", kIndent, key.name, key.help, key_kind_name(key), usual.c_str());
    }
}

void print_surface(const rt_surface& surface) {
    for (rt_u32 i = 0; i < surface.key_count; ++i) {
        const rt_surface_key& key = surface.keys[i];
        print_text("%s%-20s %s (%g to %g; default %g)\n", kIndent, key.name, key.help, key.min, key.max, key.def[0]);
    }
}

void print_plugin(const PluginRecord& record) {
    const rt_plugin& plugin = *record.plugin;
    print_text("%-9s %s  (%s, %s)%s\n%s%s\n", plugin_kind(plugin), plugin.id, plugin.name, plugin.version,
               record.shadowed ? "  SHADOWED: a library above has the same id, this one is not used" : "", kIndent,
               record.path.c_str());
    if (record.replaced > 0) print_text("%sbuilt again and replaced %s\n", kIndent, plural(record.replaced, "time").c_str());
    if (plugin.reference) print_text("%sreference: %s\n", kIndent, plugin.reference);
    if (plugin.accel) print_accel(*plugin.accel);
    if (plugin.primitive) print_keys(*plugin.primitive);
    if (const rt_surface* surface = rt_surface_of(&plugin)) print_surface(*surface);
    if (plugin.importer && plugin.importer->extensions[0]) {
        print_text("%sfiles:", kIndent);
        for (const char* const* e = plugin.importer->extensions; *e; ++e) print_text(" .%s", *e);
        print_text("\n");
    }
    for (const rt_extension* e = plugin.extensions; e && e->name; ++e)
        print_text("%sextension: %s, version %u\n", kIndent, e->name, unsigned(e->version));
    const ParameterValues defaults = default_parameters(plugin);
    for (rt_u32 i = 0; i < plugin.param_count; ++i) {
        const rt_param& param = plugin.params[i];
        print_text("%s%-20s %s (%s; needs a %s)\n", kIndent, parameter_text(plugin, defaults, i).c_str(), param.help,
                   range_text(param).c_str(), effect_name(param.effect));
    }
}

}  // namespace

int run_plugins(const PluginRegistry& plugins, bool json) {
    if (json) {
        Json list = {{"abi_version", RT_ABI_VERSION}, {"plugins", Json::array()}};
        for (const PluginRecord& record : plugins.records()) list["plugins"].push_back(record_json(record));
        // A path may not be UTF-8, but JSON must be.
        std::printf("%s\n", list.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
        return 0;
    }
    for (const PluginRecord& record : plugins.records()) {
        if (record.plugin)
            print_plugin(record);
        else
            print_text("REFUSED   %s\n%s%s\n", record.path.c_str(), kIndent, record.why.c_str());
    }
    if (plugins.records().empty())
        print_text("no plugins found; name a folder of them in CLARITY_PLUGIN_PATH, or a library with --plugin FILE\n");
    return 0;
}

}  // namespace clarity
