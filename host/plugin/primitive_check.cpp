// primitive_check.cpp -- checks the description of a shape: its keys, its kernels and its functions.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "base/problem.hpp"
#include "plugin/plugin_check.hpp"

namespace clarity {
namespace {

bool is_list(const rt_key& key) {
    return key.kind == RT_KEY_NUMBERS || key.kind == RT_KEY_POINTS;
}

Problem check_key(const rt_key& key, rt_u32 number) {
    if (Problem why = check_key_name(key.name, number)) return why;
    const std::string where = "key '" + std::string(key.name) + "'";
    if (std::strcmp(key.name, "material") == 0) return where + " is a key of every statement: take another name";
    if (const Problem why = check_text("help", key.help, true)) return where + ": " + why.text();
    if (key.kind > RT_KEY_POINTS) return where + " has the unknown kind " + std::to_string(key.kind);
    if (!std::isfinite(key.min) || !std::isfinite(key.max) || key.min > key.max)
        return where + ": expected finite min <= max, found " + std::to_string(key.min) + ", " + std::to_string(key.max);
    if (is_list(key) || (key.flags & RT_KEY_REQUIRED)) return {};
    const int count = key.kind == RT_KEY_POINT || key.kind == RT_KEY_VECTOR ? 3 : 1;
    const bool sound = std::all_of(key.def, key.def + count, [&](double x) { return x >= key.min && x <= key.max; });
    if (!sound) return where + ": its default is outside of its range; set RT_KEY_REQUIRED if it has none";
    return {};
}

}  // namespace

Problem check_primitive(const rt_primitive& primitive) {
    if (primitive.kernel_contract != RT_KERNEL_CONTRACT)
        return "its kernels were written for version " + std::to_string(primitive.kernel_contract) +
               " of the kernel contract, this host offers " + std::to_string(RT_KERNEL_CONTRACT) +
               ": write RT_KERNEL_CONTRACT into kernel_contract, and see in CONTRACT.md what that version asks";
    if (primitive.key_count == 0 || primitive.key_count > kMaxKeys)
        return "it declares " + std::to_string(primitive.key_count) + " keys, expected 1 to " + std::to_string(kMaxKeys);
    if (!primitive.keys) return "keys is NULL";
    std::set<std::string> names;
    size_t numbers = 0;
    bool lists = false;
    for (rt_u32 i = 0; i < primitive.key_count; ++i) {
        const rt_key& key = primitive.keys[i];
        if (Problem why = check_key(key, i)) return why;
        if (!names.insert(key.name).second) return std::string("it has two keys '") + key.name + "'";
        numbers += key.kind == RT_KEY_POINT || key.kind == RT_KEY_VECTOR ? 3 : 1;
        lists = lists || is_list(key);
    }
    if (Problem why = check_kernel_file(primitive.kernels)) return why;
    if (primitive.prepare) return {};
    if (!primitive.bounds) return "it has neither bounds nor prepare, so no structure could hold it";
    if (lists || numbers > RT_SHAPE_NUMBERS)
        return "its keys hold more than " + std::to_string(RT_SHAPE_NUMBERS) +
               " numbers, which its kernels cannot take as they are: write prepare";
    return {};
}

}  // namespace clarity
