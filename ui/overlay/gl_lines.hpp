// gl_lines.hpp -- draws lines of the world over a picture. Parts in front of the picture's surfaces have full colour, parts
// behind them are faint. The lines are drawn into a texture of their own, and only when something changed, so that thousands of
// volumes do not slow the window's other frames.
#pragma once
#include <cstdint>
#include <vector>

#include "base/pictures/image_io.hpp"
#include "ui/overlay/line_quads.hpp"

namespace clarity::ui {

// The picture's surfaces, which hide lines: distances of the camera rays, +inf for a miss, as a texture and as numbers. Without
// them every line is in front.
struct LinesBehind {
    unsigned distance = 0;  // name of a texture; 0: there is none
    const FloatImage* values = nullptr;
    float opacity = 1;  // of parts behind a surface
};

// Draws line lists into a texture. Its GL context must be current during its whole life.
class LineLayer {
 public:
    LineLayer() = default;
    ~LineLayer();
    LineLayer(const LineLayer&) = delete;
    LineLayer& operator=(const LineLayer&) = delete;

    // Draws the lists in order, as `projection` sees them. scale: pixels for each unit of the window. Long lists are drawn
    // thin, since their lines could not be told apart anyway. Changes the GL state of framebuffer, viewport, program, blending
    // and vertex array.
    void draw(const std::vector<const LineList*>& lists, const Projection& projection, float scale, const LinesBehind& behind);
    // Empty, or the shader compiler's log; then no lines are drawn.
    const std::string& failure() const { return failure_; }
    // RGBA8, premultiplied, lowest row first.
    unsigned texture() const { return texture_; }
    size_t drawn() const { return drawn_; }  // number of lines drawn last time

 private:
    bool make_program();
    bool resize(int width, int height);
    void fill_indices(size_t quads);

    std::string failure_;
    unsigned program_ = 0, vertex_array_ = 0, vertices_ = 0, indices_ = 0, frame_buffer_ = 0, texture_ = 0;
    int width_ = 0, height_ = 0;
    int size_location_ = -1, half_size_location_ = -1, tested_location_ = -1, behind_location_ = -1;
    size_t indexed_ = 0, drawn_ = 0;
    std::vector<LineVertex> scratch_;
};

}  // namespace clarity::ui
