// picture_texture.hpp -- pictures as textures, uploaded through a pixel buffer object.
#pragma once
#include <string>

#include "base/pictures/image_io.hpp"
#include "base/problem.hpp"

namespace clarity::ui {

// A texture with a picture. Its GL context must be current during its whole life.
class PictureTexture {
 public:
    PictureTexture() = default;
    ~PictureTexture();
    PictureTexture(const PictureTexture&) = delete;
    PictureTexture& operator=(const PictureTexture&) = delete;

    // Uploads a picture. Returns nothing, or why it cannot be shown: it is larger than this OpenGL's textures can be.
    Problem upload(const ByteImage& image);
    // Uploads one channel as R32F.
    Problem upload(const FloatImage& image);
    // true: show the nearest texel, so that the pixels of an enlarged picture can be told apart.
    void set_magnified(bool magnified);
    unsigned name() const { return texture_; }
    unsigned width() const { return width_; }
    unsigned height() const { return height_; }

 private:
    Problem stream(const void* pixels, unsigned width, unsigned height, int store, unsigned format, unsigned type);
    unsigned texture_ = 0, buffer_ = 0, width_ = 0, height_ = 0;
    bool magnified_ = false;
};

}  // namespace clarity::ui
