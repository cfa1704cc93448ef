// picture_layout.hpp -- where pictures lie in the room that they have: one, two that are wiped, two side by side. Pure
// arithmetic.
#pragma once
#include <glm/vec2.hpp>
#include <vector>

#include "ui/app/ui_state.hpp"
#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

struct PicturePlace {
    enum class What { main, other, difference };
    What what = What::main;
    Rect area;   // the whole picture
    Rect shown;  // the part of it that is shown
    // The side of the picture whose camera rays' distances go with it.
    unsigned side() const { return what == What::other ? 1 : 0; }
};

// head: height of the captions, which stand above pictures that lie side by side and over the others. foot: what shall be free
// below those, if it can be without making them smaller.
std::vector<PicturePlace> lay_out_pictures(const Rect& room, float aspect, bool compared, CompareMode mode, float wipe,
                                           float head, float foot);

// The pixel of a picture of width x height at a place of its area; false outside.
bool pixel_at(const Rect& area, const glm::vec2& place, unsigned width, unsigned height, unsigned& x, unsigned& y);

}  // namespace clarity::ui
