// scripted_window.hpp -- the parts of the window that a script reads and drives.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "ui/overlay/overlay.hpp"
#include "ui/session/session.hpp"
#include "ui/viewport/picture_pane.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

// Counters of the window itself.
struct UiTimes {
    unsigned long frames = 0;
    double slowest_frame_ms = 0;   // longest turn of the loop, without its waiting
    double slowest_answer_ms = 0;  // longest time from a key event to the end of the frame that handled it
};

// Valid while the script runs a line.
struct ScriptedWindow {
    Session& session;
    UiState& state;
    VolumeOverlay& overlay;
    const PicturePane& pane;
    UiTimes& times;
    std::function<void(const std::vector<std::string>&)> drop;  // files onto the window
    std::function<void(const std::string&)> capture;            // writes the next frame to this path as PNG
    std::function<void()> close;
    std::function<void(float)> set_double_click;  // seconds between its clicks at most; 0: as usual
};

}  // namespace clarity::ui
