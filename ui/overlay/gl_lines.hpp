// gl_lines.hpp -- lines of the world drawn over a picture: each point of them in full colour where it lies in front of what the
// picture shows, faint where it lies behind. They go into a texture of their own, which is drawn anew only when something
// changed, so that thousands of volumes do not slow the window's other frames.
#pragma once
#include <cstdint>
#include <vector>

#include "ui/overlay/line_quads.hpp"
#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

// What hides lines: the distances of the picture's camera rays, +inf where they met nothing, as a texture and as numbers.
// Without them all is in front.
struct LinesBehind {
    const PictureTexture* distance = nullptr;
    const FloatImage* values = nullptr;
    float opacity = 1;  // of what lies behind
};

// Needs the GL context current, for all of its life.
class LineLayer {
 public:
    LineLayer() = default;
    ~LineLayer();
    LineLayer(const LineLayer&) = delete;
    LineLayer& operator=(const LineLayer&) = delete;

    // Draws the lists, one after the other, as `projection` sees them. scale: pixels to a unit of the window. Long lists, whose
    // lines could not be told apart anyway, are drawn thin. Changes the GL state of framebuffer, viewport, program, blending
    // and vertex array.
    void draw(const std::vector<const LineList*>& lists, const Projection& projection, float scale, const LinesBehind& behind);
    // Empty, or the shader compiler's words: there will be no lines.
    const std::string& failure() const { return failure_; }
    // RGBA8, premultiplied, the first row the lowest.
    unsigned texture() const { return texture_; }
    size_t drawn() const { return drawn_; }  // lines, last time

 private:
    bool make_program();
    bool resize(int width, int height);
    void fill_indices(size_t quads);

    std::string failure_;
    unsigned program_ = 0, vertex_array_ = 0, vertices_ = 0, indices_ = 0, frame_buffer_ = 0, texture_ = 0;
    int width_ = 0, height_ = 0;
    int size_place_ = -1, half_size_place_ = -1, tested_place_ = -1, behind_place_ = -1;
    size_t indexed_ = 0, drawn_ = 0;
    std::vector<LineVertex> scratch_;
};

}  // namespace clarity::ui
