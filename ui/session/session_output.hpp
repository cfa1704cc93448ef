// session_output.hpp -- what a session leaves on disk besides pictures and presets.
#pragma once
#include <string>

#include "ui/session/session.hpp"

namespace clarity::ui {

// Writes the scene with its edits as a text scene: see scene_text.hpp. Throws Error.
void save_scene(const Session& session, const std::string& path);
// Where to, if the user names no path: the open text scene itself, else one beside the first file.
std::string scene_path(const Session& session);

// How fast the pictures of a session come.
double frames_per_second(const Session& session, unsigned side = 0);  // over the last ten frames
double mrays_per_second(const Session& session, unsigned side = 0);   // of the newest picture, by the device's time
std::string frame_rate_line(const Session& session);                  // both, and the settings that they depend on

}  // namespace clarity::ui
