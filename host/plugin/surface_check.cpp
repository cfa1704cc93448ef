// surface_check.cpp -- checks the description of a surface: its keys and its kernels.
#include <cmath>
#include <set>

#include "plugin/plugin_check.hpp"

namespace clarity {
namespace {

Problem check_key(const rt_surface_key& key, rt_u32 number) {
    if (Problem why = check_key_name(key.name, number)) return why;
    const std::string where = "key '" + std::string(key.name) + "'";
    if (const Problem why = check_text("label", key.label, true)) return where + ": " + why.text();
    if (const Problem why = check_text("unit", key.unit, false)) return where + ": " + why.text();
    if (const Problem why = check_text("help", key.help, true)) return where + ": " + why.text();
    if (key.kind != RT_KEY_NUMBER && key.kind != RT_KEY_COLOR)
        return where + " has the kind " + std::to_string(key.kind) + ", expected RT_KEY_NUMBER or RT_KEY_COLOR";
    const int count = key.kind == RT_KEY_COLOR ? 3 : 1;
    bool sound = std::isfinite(key.min) && std::isfinite(key.max);
    for (int k = 0; k < count; ++k) sound = sound && key.def[k] >= key.min && key.def[k] <= key.max;
    if (!sound) return where + ": expected finite min <= def <= max";
    return {};
}

}  // namespace

Problem check_surface(const rt_surface& surface) {
    if (surface.key_count > RT_SURFACE_NUMBERS || (surface.key_count > 0 && !surface.keys))
        return "it declares " + std::to_string(surface.key_count) + " keys, at most " + std::to_string(RT_SURFACE_NUMBERS) +
               " are taken, and they are an array";
    std::set<std::string> names;
    rt_u32 numbers = 0;
    for (rt_u32 i = 0; i < surface.key_count; ++i) {
        if (Problem why = check_key(surface.keys[i], i)) return why;
        if (!names.insert(surface.keys[i].name).second) return std::string("it has two keys '") + surface.keys[i].name + "'";
        numbers += surface.keys[i].kind == RT_KEY_COLOR ? 3 : 1;
    }
    if (numbers > RT_SURFACE_NUMBERS)
        return "its keys hold " + std::to_string(numbers) + " numbers, at most " + std::to_string(RT_SURFACE_NUMBERS) +
               " are taken";
    return check_kernel_file(surface.kernels);
}

}  // namespace clarity
