// plugin_check.hpp -- checks whether a plugin's description is sound. Reads only data and runs none of the plugin's code.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "base/problem.hpp"
#include "rt_plugin.h"
#include "rt_surface.h"

namespace clarity {

// Far more than any plugin needs, and far less than a random word is likely to hold.
inline constexpr uint32_t kMaxParams = 64, kMaxSlots = 16, kMaxExtensions = 64, kMaxKeys = 24;

// True for [a-z][a-z0-9_]*, at most 32 bytes.
bool is_plugin_id(std::string_view text);

// True if C, OpenCL C and a command line accept the name as one word: letters, digits and _, at most 64 characters. False for
// nullptr.
bool is_identifier(const char* text);

// Checks the first four words of rt_plugin, which stay in place in every version of the ABI. `object_bytes`: size of the
// exported symbol, which struct_bytes must not exceed. Returns nothing if this host can read the rest, otherwise what was
// found, what was expected and what to do.
Problem check_plugin_head(const uint32_t head[4], uint64_t object_bytes);

// Nothing if the text is one line that can be shown, otherwise what is wrong with it. what: what it is, "help".
Problem check_text(const char* what, const char* text, bool required);

// Check the name of key `number` of a shape or surface, and the file of its kernels.
Problem check_key_name(const char* name, rt_u32 number);
Problem check_kernel_file(const rt_cl_file& file);

// Check the description of a surface, and of a shape.
Problem check_surface(const rt_surface& surface);
Problem check_primitive(const rt_primitive& primitive);

// Checks everything after the head: names, parameters, tables, required functions. `plugin` has structs of this host's size
// (copy_plugin). Returns nothing if it is sound.
Problem check_plugin(const rt_plugin& plugin);

}  // namespace clarity
