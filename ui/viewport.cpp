#include "ui/viewport.hpp"

#include <epoxy/gl.h>

#include <cmath>
#include <cstring>

namespace clarity {

PictureTexture::~PictureTexture() {
    if (texture_) glDeleteTextures(1, &texture_);
    if (buffer_) glDeleteBuffers(1, &buffer_);
}

std::string PictureTexture::upload(const ByteImage& image) {
    if (image.width == 0 || image.height == 0) return {};
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (image.width > static_cast<unsigned>(largest) || image.height > static_cast<unsigned>(largest))
        return "a picture of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
               " cannot be shown: OpenGL takes " + std::to_string(largest) +
               " pixels a side here; `clarity render` writes it to a file";
    const bool fresh = texture_ == 0;
    if (fresh) {
        glGenTextures(1, &texture_);
        glGenBuffers(1, &buffer_);
    }
    glBindTexture(GL_TEXTURE_2D, texture_);
    if (fresh) {
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    const auto width = static_cast<GLsizei>(image.width), height = static_cast<GLsizei>(image.height);
    if (image.width != width_ || image.height != height_) {
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
        width_ = image.width;
        height_ = image.height;
    }
    // A fresh store each time: the driver may still read the last one.
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_);
    const auto bytes = static_cast<GLsizeiptr>(image.pixels.size());
    glBufferData(GL_PIXEL_UNPACK_BUFFER, bytes, nullptr, GL_STREAM_DRAW);
    if (void* into = glMapBufferRange(GL_PIXEL_UNPACK_BUFFER, 0, bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT)) {
        std::memcpy(into, image.pixels.data(), image.pixels.size());
        glUnmapBuffer(GL_PIXEL_UNPACK_BUFFER);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
        glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
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

Rect letter_box(const Rect& area, float aspect) {
    float width = area.width, height = area.width / aspect;
    if (height > area.height) {
        height = area.height;
        width = area.height * aspect;
    }
    return {std::floor(area.x + (area.width - width) / 2), std::floor(area.y + (area.height - height) / 2), width, height};
}

}  // namespace clarity
