// line_quads.hpp -- lines of the world as quads on the screen, clipped at the eye and at the picture's border. Core profiles
// draw lines one pixel wide and no wider, and clipping here keeps coordinates exact where a line passes close by the eye.
#pragma once
#include <cstdint>
#include <vector>

#include "render/film/image_io.hpp"
#include "ui/overlay/line_list.hpp"
#include "ui/viewport/projection.hpp"

namespace clarity::ui {

// 24 bytes, as gl_lines' shader reads it.
struct LineVertex {
    float x, y;        // pixels from the picture's upper left corner
    float inv_depth;   // 1 / distance along the line of sight: linear on the screen
    float across;      // pixels from the line's middle, to one side negative
    float half_width;  // pixels
    uint32_t color;    // as Line has it
};

// A surface that a line lies on shall not hide it, though its distance is that of the pixel's middle: hence a little play, in
// parts of the distance.
inline constexpr float kDistancePlay = 0.003f;

// How thousands of lines are drawn for less: one pixel wide, with two vertices each; short ones that lie behind what the
// picture shows are left out, as faint as they would be.
struct ThinLines {
    const FloatImage* distance = nullptr;  // of the picture, as LineLayer has it; nullptr: all are drawn
};

// Appends four vertices for each line that shows, in the order of two triangles 0 1 2, 2 1 3; or, thin, its two ends. scale:
// pixels to a unit of the window. Lines shorter than a quarter of a pixel are left out.
void append_quads(const LineList& lines, const Projection& projection, float scale, std::vector<LineVertex>& vertices);
void append_thin(const LineList& lines, const Projection& projection, float scale, const ThinLines& thin,
                 std::vector<LineVertex>& vertices);

}  // namespace clarity::ui
