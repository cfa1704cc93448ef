// viewport.hpp -- pictures as textures, fed through a pixel buffer object; rectangles of the window.
#pragma once
#include <string>

#include "render/film/image_io.hpp"

namespace clarity::ui {

// Needs the GL context current, for all of its life.
class PictureTexture {
 public:
    PictureTexture() = default;
    ~PictureTexture();
    PictureTexture(const PictureTexture&) = delete;
    PictureTexture& operator=(const PictureTexture&) = delete;

    // Empty, or why the picture cannot be shown: this OpenGL's textures are not that large.
    std::string upload(const ByteImage& image);
    // Of one channel, as R32F.
    std::string upload(const FloatImage& image);
    // Nearest texel where the picture is shown larger than it is, so that pixels can be told apart.
    void set_magnified(bool magnified);
    unsigned name() const { return texture_; }
    unsigned width() const { return width_; }
    unsigned height() const { return height_; }

 private:
    std::string stream(const void* pixels, unsigned width, unsigned height, int store, unsigned format, unsigned type);
    unsigned texture_ = 0, buffer_ = 0, width_ = 0, height_ = 0;
    bool magnified_ = false;
};

// A rectangle in window coordinates.
struct Rect {
    float x = 0, y = 0, width = 0, height = 0;
    bool holds(float px, float py) const { return px >= x && py >= y && px < x + width && py < y + height; }
};
// The largest of that aspect inside the area, centred.
Rect letter_box(const Rect& area, float aspect);

}  // namespace clarity::ui
