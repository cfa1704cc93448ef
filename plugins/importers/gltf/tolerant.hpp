// tolerant.hpp -- a part of the file that is wrong costs that part, with a warning that names its place.
#pragma once
#include "document.hpp"
#include "rt_plugin.hpp"

namespace gltf_import {

// Runs `read`. If the file is wrong there, warns, and returns false. loss: what is missing then, "the channel is left out".
template <class Read>
bool spared(const rt_scene_sink& sink, const std::string& loss, const Read& read) {
    try {
        read();
        return true;
    } catch (const Error& error) {
        rt::warn(sink, error.what() + ("; " + loss));
        return false;
    }
}

// A list of the document that holds no geometry. If it is no list, warns, and returns an empty one.
inline Value spared_list(const Document& document, const char* name, const rt_scene_sink& sink) {
    static const nlohmann::json none = nlohmann::json::object();
    const bool is_good = spared(sink, "it counts as empty", [&] { document.list(name); });
    return is_good ? document.list(name) : Value(none, "").list(name);
}

}  // namespace gltf_import
