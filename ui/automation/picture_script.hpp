// picture_script.hpp -- the commands of the window's script which concern the picture.
//   mode wipe|side|difference   how two sides are shown        wipe SHARE        its place, of the picture's width
//   follow 0|1   the inspector follows the mouse               rays 0|1          the inspected rays are drawn
//   lights 0|1   lights have handles                           behind 0|1        volumes behind surfaces are drawn
//   layout       answers with JSON: rectangles of pictures and handles, number of lines, whether rays are drawn
#pragma once
#include <string>

namespace clarity::ui {

struct ScriptedWindow;

// Runs one command. Returns false if it is none of the commands above. Throws Error(usage).
bool run_picture_command(ScriptedWindow& window, const std::string& command, const std::string& text);

}  // namespace clarity::ui
