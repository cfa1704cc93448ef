// line_quads.hpp -- turns lines of the world into quads on the screen, clipped at the eye and at the picture's border. OpenGL
// core profiles only draw lines one pixel wide. Clipping here keeps coordinates exact if a line passes close to the eye.
#pragma once
#include <cstdint>
#include <vector>

#include "base/pictures/image_io.hpp"
#include "ui/overlay/line_list.hpp"
#include "ui/overlay/projection.hpp"

namespace clarity::ui {

// A vertex of 24 bytes, in the layout which gl_lines' shader reads.
struct LineVertex {
    float x, y;        // pixels from the picture's upper left corner
    float inv_depth;   // 1 / distance along the line of sight, which is linear on the screen
    float across;      // pixels from the line's middle, negative on one side
    float half_width;  // pixels
    uint32_t color;    // as in Line
};

// Tolerance of the depth test, as a share of the distance. A surface must not hide a line that lies on it, although its
// distance is that of the pixel's centre.
inline constexpr float kDistancePlay = 0.003f;

// Options for drawing thousands of lines cheaply: one pixel wide, with two vertices each. Short lines behind the picture's
// surfaces are omitted, because they would be faint.
struct ThinLines {
    const FloatImage* distance = nullptr;  // of the picture, as in LinesBehind; nullptr: no line is omitted
};

// Append the visible lines. append_quads adds four vertices for each line, for the triangles 0 1 2 and 2 1 3; append_thin adds
// the two ends. scale: pixels for each unit of the window. Lines shorter than a quarter of a pixel are omitted.
void append_quads(const LineList& lines, const Projection& projection, float scale, std::vector<LineVertex>& vertices);
void append_thin(const LineList& lines, const Projection& projection, float scale, const ThinLines& thin,
                 std::vector<LineVertex>& vertices);

}  // namespace clarity::ui
