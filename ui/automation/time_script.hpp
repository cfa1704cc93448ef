// time_script.hpp -- the commands of the window's script which concern the timeline.
//   play 0|1     plays or pauses           time SECONDS|rest   shows this time, or the scene at rest
//   clip NAME    chooses a clip            step N              N frames on
//   loop A B     seconds                   speed FACTOR        of the clip's clock
//   timeline     answers with JSON: clips, clip, time, loop, speed, playing, and the time of the picture that is shown
#pragma once
#include <string>

namespace clarity::ui {

struct ScriptedWindow;

// Runs one command. Returns false if it is none of the commands above. Throws Error(usage).
bool run_time_command(ScriptedWindow& window, const std::string& command, const std::string& text);

}  // namespace clarity::ui
