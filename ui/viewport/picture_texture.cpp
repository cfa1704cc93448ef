#include "ui/viewport/picture_texture.hpp"

#include <epoxy/gl.h>

#include <cmath>
#include <cstring>

namespace clarity::ui {

PictureTexture::~PictureTexture() {
    if (texture_) glDeleteTextures(1, &texture_);
    if (buffer_) glDeleteBuffers(1, &buffer_);
}

Problem PictureTexture::upload(const ByteImage& image) {
    return stream(image.pixels.data(), image.width, image.height, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
}

Problem PictureTexture::upload(const FloatImage& image) {
    return stream(image.pixels.data(), image.width, image.height, GL_R32F, GL_RED, GL_FLOAT);
}

// Uploads texels of four bytes, which both formats have.
Problem PictureTexture::stream(const void* pixels, unsigned width, unsigned height, int store, unsigned format, unsigned type) {
    if (width == 0 || height == 0) return {};
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (width > static_cast<unsigned>(largest) || height > static_cast<unsigned>(largest))
        return "a picture of " + std::to_string(width) + "x" + std::to_string(height) + " cannot be shown: OpenGL takes " +
               std::to_string(largest) + " pixels a side here; `clarity render` writes it to a file";
    const bool fresh = texture_ == 0;
    if (fresh) {
        glGenTextures(1, &texture_);
        glGenBuffers(1, &buffer_);
    }
    glBindTexture(GL_TEXTURE_2D, texture_);
    if (fresh) {
        // A mean of neighbouring distances has no meaning.
        const GLint filter = store == GL_R32F ? GL_NEAREST : GL_LINEAR;
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    const auto columns = static_cast<GLsizei>(width), rows = static_cast<GLsizei>(height);
    if (width != width_ || height != height_) {
        glTexImage2D(GL_TEXTURE_2D, 0, store, columns, rows, 0, format, type, nullptr);
        width_ = width;
        height_ = height;
    }
    // Allocate new storage each time, because the driver may still read the old one.
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_);
    const auto bytes = static_cast<GLsizeiptr>(size_t{4} * width * height);
    glBufferData(GL_PIXEL_UNPACK_BUFFER, bytes, nullptr, GL_STREAM_DRAW);
    if (void* into = glMapBufferRange(GL_PIXEL_UNPACK_BUFFER, 0, bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT)) {
        std::memcpy(into, pixels, static_cast<size_t>(bytes));
        glUnmapBuffer(GL_PIXEL_UNPACK_BUFFER);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, columns, rows, format, type, nullptr);
    }
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    return {};
}

void PictureTexture::set_magnified(bool magnified) {
    if (!texture_ || magnified == magnified_) return;
    magnified_ = magnified;
    glBindTexture(GL_TEXTURE_2D, texture_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, magnified ? GL_NEAREST : GL_LINEAR);
}

}  // namespace clarity::ui
