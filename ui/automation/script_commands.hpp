// script_commands.hpp -- the commands of the window's script which concern the timeline,
//   play 0|1     plays or pauses           time SECONDS|rest   shows this time, or the scene at rest
//   clip NAME    chooses a clip            step N              N frames on
//   loop A B     seconds                   speed FACTOR        of the clip's clock
//   timeline     answers with JSON: clips, clip, time, loop, speed, playing, and the time of the picture that is shown
// and the picture:
//   mode wipe|side|difference   how two sides are shown        wipe SHARE        its place, of the picture's width
//   follow 0|1   the inspector follows the mouse               rays 0|1          the inspected rays are drawn
//   lights 0|1   lights have handles                           behind 0|1        volumes behind surfaces are drawn
//   layout       answers with JSON: rectangles of pictures and handles, number of lines, whether rays are drawn
#pragma once
#include <string>

namespace clarity::ui {

struct ScriptedWindow;

// Runs one command. Returns false if it is none of the commands above. Throws Error(usage).
bool run_time_command(ScriptedWindow& window, const std::string& command, const std::string& text);

// Runs one command. Returns false if it is none of the commands above. Throws Error(usage).
bool run_picture_command(ScriptedWindow& window, const std::string& command, const std::string& text);

}  // namespace clarity::ui
