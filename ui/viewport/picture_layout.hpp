// picture_layout.hpp -- places the pictures in the room that they have: one picture, two with a wipe, or two side by side. Pure
// arithmetic.
#pragma once
#include <glm/vec2.hpp>
#include <vector>

#include "ui/widgets/rect.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

// A picture and its place in the window.
struct PicturePlace {
    enum class What { main, other, difference };
    What what = What::main;
    Rect area;   // the whole picture
    Rect shown;  // the visible part of it
    // The side that has the distances of this picture.
    unsigned side() const { return what == What::other ? 1 : 0; }
};

// head: height of the captions. They are above pictures which lie side by side, and over the picture in the other modes. foot:
// height to keep free below pictures side by side, if they need not become smaller for it.
std::vector<PicturePlace> lay_out_pictures(const Rect& room, float aspect, bool compared, CompareMode mode, float wipe,
                                           float head, float foot);

// Finds the pixel at `place` in a picture of width x height. Returns false if `place` is outside of `area`.
bool pixel_at(const Rect& area, const glm::vec2& place, unsigned width, unsigned height, unsigned& x, unsigned& y);

}  // namespace clarity::ui
