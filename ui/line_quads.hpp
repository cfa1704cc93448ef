// line_quads.hpp -- lines of the world as quads on the screen, clipped at the eye and at the picture's border. Core profiles
// draw lines one pixel wide and no wider, and clipping here keeps coordinates exact where a line passes close by the eye.
#pragma once
#include <cstdint>
#include <vector>

#include "ui/line_list.hpp"
#include "ui/projection.hpp"

namespace clarity {

// 24 bytes, as gl_lines' shader reads it.
struct LineVertex {
    float x, y;        // pixels from the picture's upper left corner
    float inv_depth;   // 1 / distance along the line of sight: linear on the screen
    float across;      // pixels from the line's middle, to one side negative
    float half_width;  // pixels
    uint32_t color;    // as Line has it
};

// Appends four vertices for each line that shows, in the order of two triangles 0 1 2, 2 1 3. scale: pixels to a unit of the
// window. Lines shorter than a quarter of a pixel are left out.
void append_quads(const LineList& lines, const Projection& projection, float scale, std::vector<LineVertex>& vertices);

}  // namespace clarity
