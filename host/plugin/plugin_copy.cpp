#include "plugin/plugin_copy.hpp"

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "base/problem.hpp"
#include "plugin/abi_struct.hpp"
#include "plugin/plugin_check.hpp"

namespace clarity {
namespace {

struct Copy {
    rt_plugin plugin{};
    rt_accel accel{};
    rt_importer importer{};
    rt_primitive primitive{};
    std::vector<rt_param> params;
    std::vector<rt_slot> slots;
    std::vector<rt_key> keys;
    std::vector<rt_extension> extensions;  // with the one that ends them
};

template <class T>
const T* copy_array(const T* from, uint32_t count, uint32_t bytes, std::vector<T>& to) {
    const char* at = reinterpret_cast<const char*>(from);
    for (uint32_t i = 0; i < count; ++i, at += bytes) to.push_back(copied<T>(at, bytes));
    return to.data();
}

Problem copy_extensions(rt_plugin& plugin, std::vector<rt_extension>& to) {
    if (!plugin.extensions) return {};
    if (Problem why = check_bytes<rt_extension>("rt_extension", plugin.extension_bytes, "extension_bytes")) return why;
    const char* at = reinterpret_cast<const char*>(plugin.extensions);
    for (uint32_t i = 0; i <= kMaxExtensions; ++i, at += plugin.extension_bytes) {
        to.push_back(copied<rt_extension>(at, plugin.extension_bytes));
        if (to.back().name) continue;
        plugin.extensions = to.data();
        return {};
    }
    return "its extensions have no element without a name at the end";
}

Problem fill(Copy& copy, const rt_plugin& from) {
    rt_plugin& plugin = copy.plugin;
    plugin = copied<rt_plugin>(&from, from.struct_bytes);
    // Counts that are too large and missing arrays are left to check_plugin(), which looks at nothing behind them then.
    if (plugin.param_count > 0 && plugin.param_count <= kMaxParams && plugin.params) {
        if (Problem why = check_bytes<rt_param>("rt_param", plugin.param_bytes, "param_bytes")) return why;
        plugin.params = copy_array(plugin.params, plugin.param_count, plugin.param_bytes, copy.params);
    }
    if (plugin.accel) {
        if (Problem why = check_bytes<rt_accel>("rt_accel", plugin.accel->struct_bytes)) return why;
        copy.accel = copied<rt_accel>(plugin.accel, plugin.accel->struct_bytes);
        rt_accel& accel = copy.accel;
        plugin.accel = &accel;
        if (accel.slot_count > 0 && accel.slot_count <= kMaxSlots && accel.slots) {
            if (Problem why = check_bytes<rt_slot>("rt_slot", accel.slot_bytes, "slot_bytes")) return why;
            accel.slots = copy_array(accel.slots, accel.slot_count, accel.slot_bytes, copy.slots);
        }
    }
    if (plugin.importer) {
        if (Problem why = check_bytes<rt_importer>("rt_importer", plugin.importer->struct_bytes)) return why;
        copy.importer = copied<rt_importer>(plugin.importer, plugin.importer->struct_bytes);
        plugin.importer = &copy.importer;
    }
    if (plugin.primitive) {
        if (Problem why = check_bytes<rt_primitive>("rt_primitive", plugin.primitive->struct_bytes)) return why;
        rt_primitive& primitive = copy.primitive;
        primitive = copied<rt_primitive>(plugin.primitive, plugin.primitive->struct_bytes);
        plugin.primitive = &primitive;
        if (primitive.key_count > 0 && primitive.key_count <= kMaxKeys && primitive.keys) {
            if (Problem why = check_bytes<rt_key>("rt_key", primitive.key_bytes, "key_bytes")) return why;
            primitive.keys = copy_array(primitive.keys, primitive.key_count, primitive.key_bytes, copy.keys);
            primitive.key_bytes = sizeof(rt_key);
        }
    }
    return copy_extensions(plugin, copy.extensions);
}

}  // namespace

const rt_plugin* copy_plugin(const rt_plugin& plugin, Problem& why) {
    static std::mutex mutex;
    static auto* const copies = new std::map<const rt_plugin*, std::unique_ptr<Copy>>;  // never freed, as libraries are
    const std::lock_guard<std::mutex> lock(mutex);
    const auto known = copies->find(&plugin);
    if (known != copies->end()) return &known->second->plugin;
    auto copy = std::make_unique<Copy>();
    why = fill(*copy, plugin);
    if (why) return nullptr;
    return &((*copies)[&plugin] = std::move(copy))->plugin;
}

}  // namespace clarity
