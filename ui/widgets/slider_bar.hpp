// slider_bar.hpp -- draws a slider's value as a bar from the left edge, behind the number. ImGui's grab would cover the number.
#pragma once

namespace clarity::ui {

// Call it before the slider, and draw the slider with BareFrames.
void draw_slider_bar(double value, double min, double max, bool logarithmic);

// Hides the frames of sliders while it exists.
struct BareFrames {
    BareFrames();
    ~BareFrames();
    BareFrames(const BareFrames&) = delete;
    BareFrames& operator=(const BareFrames&) = delete;
};

}  // namespace clarity::ui
