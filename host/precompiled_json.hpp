// precompiled_json.hpp -- nlohmann/json.hpp for precompiled headers, its two literal operators without their bodies. What these
// call, GCC instantiates at the end of each file that has the precompiled header: 0.4 s of processor time in each. Nobody uses
// them.
#pragma once

#define _json(text, bytes) \
    _json(text, bytes);    \
    template <typename T>  \
    inline nlohmann::json unused_json(text, bytes)
#define _json_pointer(text, bytes) \
    _json_pointer(text, bytes);    \
    template <typename T>          \
    inline nlohmann::json::json_pointer unused_json_pointer(text, bytes)
#include <nlohmann/json.hpp>
#undef _json
#undef _json_pointer
