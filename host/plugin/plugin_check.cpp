#include "plugin/plugin_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>

#include "plugin/abi_struct.hpp"

namespace clarity {
namespace {

constexpr rt_u32 kMaxChoices = 64, kMaxFileExtensions = 256, kMaxElementBytes = 4096;
constexpr size_t kMaxText = 4096;

std::string hex(uint32_t word) {
    char text[16];
    std::snprintf(text, sizeof text, "0x%08x", word);
    return text;
}

}  // namespace

// Texts are shown on terminals and in the window, so they must be one line without control characters.
Problem check_text(const char* what, const char* text, bool required) {
    if (!text) return required ? std::string(what) + " is missing (NULL)" : "";
    const size_t bytes = strnlen(text, kMaxText);
    if (bytes == kMaxText) return std::string(what) + " is longer than " + std::to_string(kMaxText) + " bytes, or has no end";
    if (required && bytes == 0) return std::string(what) + " is empty";
    if (std::any_of(text, text + bytes, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
        return std::string(what) + " holds control characters";
    return {};
}

namespace {

// A type is one or more identifiers with single blanks between them: "uint", "float4", "bvh2_node", "unsigned int".
bool is_type_name(const char* text) {
    const size_t bytes = text ? strnlen(text, kMaxText) : 0;
    if (bytes == 0 || bytes > 128) return false;
    std::string word;
    for (size_t i = 0; i <= bytes; ++i) {
        if (i < bytes && text[i] != ' ') {
            word += text[i];
            continue;
        }
        if (!is_identifier(word.c_str())) return false;
        word.clear();
    }
    return true;
}

Problem check_choices(const std::string& what, const rt_param& param) {
    if (!param.choices) return what + " is an ENUM without choices";
    std::set<std::string> seen;
    rt_u32 count = 0;
    for (; count <= kMaxChoices && param.choices[count]; ++count) {
        if (const Problem why = check_text("a choice", param.choices[count], true)) return what + ": " + why.text();
        if (std::string(param.choices[count]).find_first_of(",= ") != std::string::npos)
            return what + ": the choice '" + param.choices[count] +
                   "' cannot be typed on the command line: no ',', '=' or blank in it";
        if (!seen.insert(param.choices[count]).second) return what + " has the choice '" + param.choices[count] + "' twice";
    }
    if (count == 0) return what + " is an ENUM without choices";
    if (count > kMaxChoices) return what + ": its choices have no NULL at the end";
    if (param.min != 0 || param.max != count - 1)
        return what + " is an ENUM of " + std::to_string(count) + " choices: its range must be 0.." + std::to_string(count - 1);
    return {};
}

Problem check_param(const rt_param& param, rt_u32 number) {
    if (!is_identifier(param.key)) return "parameter " + std::to_string(number) + " has no key, or one that is no identifier";
    const std::string what = "parameter '" + std::string(param.key) + "'";
    if (const Problem why = check_text("label", param.label, true)) return what + ": " + why.text();
    if (const Problem why = check_text("help", param.help, true)) return what + ": " + why.text();
    if (param.kind < RT_PARAM_INT || param.kind > RT_PARAM_ENUM)
        return what + " has the unknown kind " + std::to_string(param.kind);
    if (param.effect != RT_EFFECT_REBUILD && param.effect != RT_EFFECT_RECOMPILE)
        return what + " has the unknown effect " + std::to_string(param.effect);
    if (!std::isfinite(param.min) || !std::isfinite(param.max) || !(param.min <= param.def && param.def <= param.max))
        return what + ": expected finite min <= def <= max, found " + std::to_string(param.min) + ", " +
               std::to_string(param.def) + ", " + std::to_string(param.max);
    if (param.kind == RT_PARAM_BOOL && (param.min != 0 || param.max != 1)) return what + " is a BOOL: its range must be 0..1";
    if (param.kind != RT_PARAM_FLOAT)
        for (const double value : {param.min, param.max, param.def})
            if (value != std::floor(value)) return what + " takes whole numbers, but its range or default is none";
    return param.kind == RT_PARAM_ENUM ? check_choices(what, param) : "";
}

Problem check_params(const rt_plugin& plugin) {
    if (plugin.param_count > kMaxParams)
        return "it declares " + std::to_string(plugin.param_count) + " parameters, at most " + std::to_string(kMaxParams) +
               " are taken";
    if (plugin.param_count > 0 && !plugin.params) return "param_count is not 0, but params is NULL";
    std::set<std::string> keys;
    for (rt_u32 i = 0; i < plugin.param_count; ++i) {
        if (Problem why = check_param(plugin.params[i], i)) return why;
        if (!keys.insert(plugin.params[i].key).second)
            return std::string("it has two parameters '") + plugin.params[i].key + "'";
    }
    return {};
}

Problem check_merit(const char* which, float merit) {
    if (std::isfinite(merit) && merit >= 0) return {};
    char text[32];
    std::snprintf(text, sizeof text, "%g", double(merit));
    return std::string("its ") + which + " is " + text + ", expected a finite number, 0 or more (0: not measured)";
}

Problem check_slots(const rt_accel& accel) {
    if (accel.slot_count == 0 || accel.slot_count > kMaxSlots)
        return "it declares " + std::to_string(accel.slot_count) + " slots, expected 1 to " + std::to_string(kMaxSlots) +
               " (slot 0 holds the nodes)";
    if (!accel.slots) return "slots is NULL";
    std::set<std::string> names;
    for (rt_u32 i = 0; i < accel.slot_count; ++i) {
        const rt_slot& slot = accel.slots[i];
        const std::string what = "slot " + std::to_string(i);
        if (!is_identifier(slot.name)) return what + " has no name, or one that is no identifier";
        if (!names.insert(slot.name).second) return "two slots are named '" + std::string(slot.name) + "'";
        const std::string called = what + " ('" + slot.name + "')";
        const bool host_only = (slot.flags & RT_SLOT_HOST_ONLY) != 0;
        if (i == 0 && host_only) return called + " is RT_SLOT_HOST_ONLY, but roots are elements of it: put it behind the nodes";
        if (!host_only && !is_type_name(slot.cl_type)) return called + " has no cl_type, or one that is no type's name";
        if (slot.elem_bytes == 0 || slot.elem_bytes > kMaxElementBytes)
            return called + " has elem_bytes " + std::to_string(slot.elem_bytes) + ", expected sizeof(its element), 1 to " +
                   std::to_string(kMaxElementBytes);
    }
    return {};
}

Problem check_kernels(const rt_accel& accel) {
    if (accel.kernel_contract != RT_KERNEL_CONTRACT)
        return "its traversal was written for version " + std::to_string(accel.kernel_contract) +
               " of the kernel contract, this host offers " + std::to_string(RT_KERNEL_CONTRACT) +
               (accel.kernel_contract > RT_KERNEL_CONTRACT
                    ? ": update clarity, or write it for the version that this host offers (CONTRACT.md)"
                    : ": write RT_KERNEL_CONTRACT into kernel_contract, and see in CONTRACT.md what that version asks");
    if (accel.types.text && !accel.types.name) return "its types file has a text but no name";
    if (Problem why = check_text("the name of its types file", accel.types.name, false)) return why;
    if (Problem why = check_text("the name of its traversal file", accel.traverse.name, true)) return why;
    if (!accel.traverse.text || !*accel.traverse.text)
        return "its traversal has no text: embed <id>.cl (clarity_add_plugin does) and point traverse.text at it";
    return {};
}

// A structure that builds only a topology, for another plugin's layout.
Problem check_topology(const rt_accel& accel) {
    const size_t bytes = accel.layout ? strnlen(accel.layout, 64) : 0;
    if (!is_plugin_id(std::string_view(accel.layout ? accel.layout : "", bytes)))
        return "it builds a topology, but `layout` names no structure that traces it: write the id of one, as \"bvh2\"";
    if (!accel.topology) return std::string("its layout is '") + accel.layout + "', but topology is NULL";
    if (accel.build || accel.pack || accel.levels || accel.slot_count > 0 || accel.traverse.text || accel.types.text)
        return std::string("its layout is '") + accel.layout +
               "', so slots, kernels, build, levels and pack are that structure's: leave its own 0";
    return {};
}

Problem check_accel(const rt_accel& accel) {
    if (accel.layout || accel.topology) {
        if (Problem why = check_topology(accel)) return why;
    } else {
        if (Problem why = check_slots(accel)) return why;
        if (Problem why = check_kernels(accel)) return why;
        if (!accel.build) return "build is NULL";
    }
    if (Problem why = check_merit("merit_cpu", accel.merit_cpu)) return why;
    if (Problem why = check_merit("merit_gpu", accel.merit_gpu)) return why;
    if (accel.ray_cost != RT_RAY_COST_LOGARITHMIC && accel.ray_cost != RT_RAY_COST_LINEAR)
        return "its ray_cost is " + std::to_string(accel.ray_cost) + ", expected RT_RAY_COST_LOGARITHMIC or RT_RAY_COST_LINEAR";
    return {};
}

Problem check_device_build(const rt_device_build& build) {
    if (Problem why = check_text("the name of its kernel file", build.kernels.name, true)) return why;
    if (!build.kernels.text || !*build.kernels.text)
        return "its kernel file has no text: embed <id>_build.cl (clarity_add_plugin does) and point kernels.text at it";
    if (!build.topology && !build.pack && !build.refit) return "topology, pack and refit are all NULL: one of them is needed";
    if (build.pack && !build.elements) return "pack goes with elements, which is NULL";
    if (build.pack && !build.refit) return "pack goes with refit, which is NULL: the host refits what it packs on the device";
    if (build.refit && !build.ranges) return "refit goes with ranges, which is NULL";
    return {};
}

Problem check_extensions(const rt_plugin& plugin) {
    for (const rt_extension* e = plugin.extensions; e && e->name; ++e) {
        if (Problem why = check_text("the name of an extension", e->name, true)) return why;
        if (e->data_bytes > 0 && !e->data)
            return std::string("extension '") + e->name + "' has data_bytes " + std::to_string(e->data_bytes) +
                   ", but its data is NULL";
        if (std::strcmp(e->name, RT_REFIT) == 0 && e->version == RT_REFIT_VERSION) {
            if (Problem why = check_bytes<rt_refit>("rt_refit", e->data_bytes, "data_bytes")) return why;
            if (!plugin.accel) return "extension 'refit' belongs to acceleration structures only";
            if (!static_cast<const rt_refit*>(e->data)->refit) return "extension 'refit': its function refit is NULL";
        }
        if (std::strcmp(e->name, RT_DEVICE_BUILD) == 0 && e->version == RT_DEVICE_BUILD_VERSION) {
            if (Problem why = check_bytes<rt_device_build>("rt_device_build", e->data_bytes, "data_bytes")) return why;
            if (!plugin.accel) return "extension 'device_build' belongs to acceleration structures only";
            if (const Problem why = check_device_build(copied<rt_device_build>(e->data, e->data_bytes)))
                return "extension 'device_build': " + why.text();
        }
    }
    return {};
}

Problem check_importer(const rt_importer& importer) {
    if (!importer.extensions) return "extensions is NULL";
    rt_u32 count = 0;
    for (; count <= kMaxFileExtensions && importer.extensions[count]; ++count) {
        const char* extension = importer.extensions[count];
        const size_t bytes = strnlen(extension, kMaxText);
        const bool plain = bytes > 0 && bytes <= 32 && std::all_of(extension, extension + bytes, [](unsigned char c) {
                               return c > 0x20 && c < 0x7f && c != '.' && c != '/' && !(c >= 'A' && c <= 'Z');
                           });
        if (!plain) return "extension " + std::to_string(count) + " is not plain: lower case, no dot, for example \"obj\"";
    }
    if (count > kMaxFileExtensions) return "its extensions have no NULL at the end";
    if (count == 0 && !importer.probe) return "it has neither extensions nor probe, so that no file could be given to it";
    if (!importer.load) return "load is NULL";
    return {};
}

}  // namespace

bool is_identifier(const char* text) {
    const size_t bytes = text ? strnlen(text, kMaxText) : 0;
    if (bytes == 0 || bytes > 64) return false;
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    return letter(text[0]) && std::all_of(text, text + bytes, [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}

bool is_plugin_id(std::string_view text) {
    if (text.empty() || text.size() > 32 || text[0] < 'a' || text[0] > 'z') return false;
    return std::all_of(text.begin(), text.end(),
                       [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
}

Problem check_plugin_head(const uint32_t head[4], uint64_t object_bytes) {
    const char* rebuild = ": rebuild it against this SDK";
    if (head[0] == 0 && head[1] == 0 && head[2] == 0)
        return "rt_plugin_v1 is zero in the file, so it is filled in by code at start: make all that it is made of constexpr";
    if (head[0] != RT_ABI_VERSION)
        return "ABI version " + std::to_string(head[0]) + ", this host speaks " + std::to_string(RT_ABI_VERSION) +
               (head[0] > RT_ABI_VERSION ? ": update clarity, or rebuild the plugin against this SDK" : rebuild);
    if (Problem why = check_bytes<rt_plugin>("rt_plugin", head[1])) return why;
    if (object_bytes < head[1])
        return "rt_plugin_v1 says struct_bytes " + std::to_string(head[1]) + ", but the library exports " +
               std::to_string(object_bytes) + " bytes of it: declare it as `const rt_plugin rt_plugin_v1` and rebuild";
    if (head[2] != RT_TYPES_DIGEST)
        return "digest of the shared structs " + hex(head[2]) + ", this host has " + hex(RT_TYPES_DIGEST) +
               " (its structs have another layout: packed, of another machine, or of a changed rt_plugin.h)" + rebuild;
    return {};
}

Problem check_key_name(const char* name, rt_u32 number) {
    if (is_identifier(name) && is_plugin_id(name)) return {};
    return "key " + std::to_string(number) + " has no name, or one that is not [a-z][a-z0-9_]*";
}

Problem check_kernel_file(const rt_cl_file& file) {
    if (Problem why = check_text("the name of its kernels", file.name, true)) return why;
    if (file.text && *file.text) return {};
    return "its kernels have no text: embed <id>.cl (clarity_add_plugin does) and point kernels.text at it";
}

Problem check_plugin(const rt_plugin& plugin) {
    const size_t id_bytes = plugin.id ? strnlen(plugin.id, kMaxText) : 0;
    if (!is_plugin_id(std::string_view(plugin.id ? plugin.id : "", id_bytes)))
        return "its id is " +
               (check_text("id", plugin.id, true) ? "missing or unreadable" : "'" + std::string(plugin.id) + "'") +
               ", expected [a-z][a-z0-9_]* of at most 32 letters";
    if (Problem why = check_text("name", plugin.name, true)) return why;
    if (Problem why = check_text("version", plugin.version, true)) return why;
    if (Problem why = check_text("reference", plugin.reference, false)) return why;
    const int kinds = (plugin.accel != nullptr) + (plugin.importer != nullptr) + (plugin.primitive != nullptr);
    if (kinds > 1) return "it is more than one of accel, importer and primitive, expected exactly one: make libraries of it";
    if (kinds == 0) {
        if (const rt_surface* surface = rt_surface_of(&plugin)) return check_surface(*surface);
        for (const rt_extension* e = plugin.extensions; e && e->name; ++e)
            if (std::strcmp(e->name, RT_SURFACE) == 0)
                return "its surface is of version " + std::to_string(e->version) + " of the draft, this host has version " +
                       std::to_string(RT_SURFACE_VERSION) + ", with " + std::to_string(sizeof(rt_surface)) +
                       " bytes of data: rebuild it against this SDK";
        return "it is neither an accel nor an importer nor a primitive, expected exactly one: set one of them; a plugin of "
               "another kind needs a later clarity";
    }
    if (Problem why = check_params(plugin)) return why;
    if (Problem why = check_extensions(plugin)) return why;
    if (plugin.primitive) return check_primitive(*plugin.primitive);
    return plugin.accel ? check_accel(*plugin.accel) : check_importer(*plugin.importer);
}

}  // namespace clarity
