// image_io.hpp -- pictures to files: PNG (8 bit, sRGB), EXR and PFM (float). Files appear whole or not at all.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "render/film/byte_image.hpp"

namespace clarity {

// width x height pixels of `channels` floats, top row first.
struct FloatImage {
    unsigned width = 0, height = 0, channels = 0;
    std::vector<float> pixels;
};

// The PNG encoder counts bytes in an int.
inline constexpr uint64_t kPngMaxPixels = 1u << 27;

// By the ending of `path`: .png (written from `display`), .exr or .pfm (from `values`: 1 or 3 channels; +inf and -1 exact).
// Writes to a temporary file in the same folder, then renames. Throws Error(failed) naming file and reason; Error(usage) for
// another ending.
void write_image(const std::string& path, const FloatImage& values, const ByteImage& display);
// Whether write_image takes this path's picture from `display`; the other one may then be empty.
bool writes_display(const std::string& path);
// Throws Error(usage) early, before any work: unknown ending, folder missing or not writable.
void check_output_path(const std::string& path);
// "out_####.png", 12 -> "out_0012.png".
std::string frame_path(const std::string& pattern, int frame);

}  // namespace clarity
