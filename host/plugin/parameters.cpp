#include "plugin/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/numbers.hpp"

namespace clarity {
namespace {

bool parse_number(std::string_view text, double& value) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    return read_number(text, value);
}

std::string choice_list(const rt_param& param) {
    std::string list;
    for (const char* const* choice = param.choices; *choice; ++choice)
        list += (list.empty() ? "" : ", ") + std::string(*choice);
    return list;
}

bool parse_bool(std::string_view text, double& value) {
    for (const char* yes : {"1", "true", "on", "yes"})
        if (text == yes) return value = 1, true;
    for (const char* no : {"0", "false", "off", "no"})
        if (text == no) return value = 0, true;
    return false;
}

bool parse_choice(const rt_param& param, std::string_view text, double& value) {
    for (int i = 0; param.choices[i]; ++i)
        if (text == param.choices[i]) return value = i, true;
    // Names come first, because "8" may be a choice's name (of "2", "4", "8"). A number is an index only if no choice has that
    // name.
    double index = 0;
    if (!parse_number(text, index) || index != std::floor(index) || index < param.min || index > param.max) return false;
    value = index;
    return true;
}

std::string expected(const rt_param& param) {
    switch (param.kind) {
        case RT_PARAM_INT:
            return "a whole number from " + exact_text(param.min) + " to " + exact_text(param.max);
        case RT_PARAM_FLOAT:
            return "a number from " + exact_text(param.min) + " to " + exact_text(param.max);
        case RT_PARAM_BOOL:
            return "0, 1, true, false, on or off";
        default:
            return "one of " + choice_list(param);
    }
}

bool parse_value(const rt_param& param, std::string_view text, double& value) {
    switch (param.kind) {
        case RT_PARAM_BOOL:
            return parse_bool(text, value);
        case RT_PARAM_ENUM:
            return parse_choice(param, text, value);
        default:
            break;
    }
    double number = 0;
    if (!parse_number(text, number) || number < param.min || number > param.max) return false;
    if (param.kind == RT_PARAM_INT && number != std::floor(number)) return false;
    value = number;
    return true;
}

std::string value_text(const rt_param& param, double value) {
    if (param.kind == RT_PARAM_BOOL) return value != 0 ? "true" : "false";
    if (param.kind == RT_PARAM_ENUM && value >= 0 && value <= param.max) return param.choices[static_cast<size_t>(value)];
    return exact_text(value);
}

}  // namespace

ParameterValues default_parameters(const rt_plugin& plugin) {
    ParameterValues values;
    for (rt_u32 i = 0; i < plugin.param_count; ++i) values.push_back(plugin.params[i].def);
    return values;
}

ParameterValues fitting_parameters(const rt_plugin& plugin, const ParameterValues& values) {
    ParameterValues fitting = default_parameters(plugin);
    for (rt_u32 i = 0; i < plugin.param_count && i < values.size(); ++i) {
        const rt_param& param = plugin.params[i];
        const bool whole = param.kind == RT_PARAM_FLOAT || values[i] == std::floor(values[i]);
        if (whole && values[i] >= param.min && values[i] <= param.max) fitting[i] = values[i];
    }
    return fitting;
}

void set_parameter(const rt_plugin& plugin, ParameterValues& values, const std::string& key, const std::string& value) {
    for (rt_u32 i = 0; i < plugin.param_count; ++i) {
        const rt_param& param = plugin.params[i];
        if (key != param.key) continue;
        if (parse_value(param, value, values.at(i))) return;
        throw Error(Exit::usage, std::string(plugin.id) + ": " + key + "=" + value + ": expected " + expected(param) + " (" +
                                     param.help + "; default " + value_text(param, param.def) + ")");
    }
    std::string keys;
    for (rt_u32 i = 0; i < plugin.param_count; ++i) keys += (i ? ", " : "") + std::string(plugin.params[i].key);
    throw Error(Exit::usage, std::string(plugin.id) + " has no parameter '" + key + "'; " +
                                 (keys.empty() ? "it has none at all" : "it has: " + keys));
}

std::string parameter_text(const rt_plugin& plugin, const ParameterValues& values, size_t index) {
    if (index >= plugin.param_count || index >= values.size()) return {};
    const rt_param& param = plugin.params[index];
    return std::string(param.key) + "=" + value_text(param, values[index]);
}

PluginChoice parse_plugin_choice(const std::string& text) {
    const auto refuse = [&](const std::string& why) {
        return Error(Exit::usage, "'" + text + "': " + why + "; expected ID[,key=value...], for example bvh2,max_leaf=4");
    };
    PluginChoice choice;
    const std::string_view all = text;
    for (size_t begin = 0, part = 0; begin <= all.size(); ++part) {
        const size_t end = std::min(all.find(',', begin), all.size());
        const std::string_view piece = all.substr(begin, end - begin);
        begin = end + 1;
        if (part == 0) {
            if (piece.empty() || piece.find('=') != piece.npos) throw refuse("it does not begin with a plugin's id");
            choice.id = piece;
            continue;
        }
        const size_t equals = piece.find('=');
        if (equals == piece.npos || equals == 0 || equals + 1 == piece.size())
            throw refuse("'" + std::string(piece) + "' is no key=value");
        const std::string key(piece.substr(0, equals));
        for (const auto& setting : choice.settings)
            if (setting.first == key) throw refuse(key + " is given twice");
        choice.settings.emplace_back(key, piece.substr(equals + 1));
    }
    return choice;
}

}  // namespace clarity
