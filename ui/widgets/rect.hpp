// rect.hpp -- rectangles of the window.
#pragma once
#include <cmath>

namespace clarity::ui {

// A rectangle in window coordinates.
struct Rect {
    float x = 0, y = 0, width = 0, height = 0;
    bool holds(float px, float py) const { return px >= x && py >= y && px < x + width && py < y + height; }
};

// Returns the largest rectangle of this aspect inside the area, centred.
inline Rect letter_box(const Rect& area, float aspect) {
    float width = area.width, height = area.width / aspect;
    if (height > area.height) {
        height = area.height;
        width = area.height * aspect;
    }
    return {std::floor(area.x + (area.width - width) / 2), std::floor(area.y + (area.height - height) / 2), width, height};
}

}  // namespace clarity::ui
