// slider_bar.hpp -- a slider's value as a bar from its left edge, under the number, instead of ImGui's grab, which covers it.
#pragma once

namespace clarity::ui {

// Call before the slider, which is then drawn with its frame's colours off.
void draw_slider_bar(double value, double min, double max, bool logarithmic);

// Hides the frames of the sliders drawn while it lives.
struct BareFrames {
    BareFrames();
    ~BareFrames();
    BareFrames(const BareFrames&) = delete;
    BareFrames& operator=(const BareFrames&) = delete;
};

}  // namespace clarity::ui
