// plugin_check.hpp -- is a plugin's description sound? Reads data only, runs none of its code.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "rt_plugin.h"

namespace clarity {

// [a-z][a-z0-9_]*, at most 32 bytes.
bool is_plugin_id(std::string_view text);

// A name that C, OpenCL C and a command line take as one word: letters, digits and _, at most 64. False for nullptr.
bool is_identifier(const char* text);

// The first four words of rt_plugin, which no version of the ABI moves. `object_bytes`: size of the exported symbol, which
// struct_bytes cannot exceed. Empty if this host can read the rest, else what was found, what was expected and what to do.
std::string check_plugin_head(const uint32_t head[4], uint64_t object_bytes);

// Everything behind the head: names, parameters, tables, required functions. Empty if sound.
std::string check_plugin(const rt_plugin& plugin);

}  // namespace clarity
