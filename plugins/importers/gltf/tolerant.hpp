// tolerant.hpp -- a part of the file that is wrong costs that part, with a warning that names its place.
#pragma once
#include "json_text.hpp"
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

}  // namespace gltf_import
