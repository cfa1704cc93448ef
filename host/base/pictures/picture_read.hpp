// picture_read.hpp -- reads pictures of colours as floats: those that are compared, and skies.
#pragma once
#include <array>
#include <string>

#include "base/pictures/float_image.hpp"

namespace clarity {

// Reads a picture of colours as linear values, top row first: PFM (1 or 3 channels), EXR (R, G, B or Y of the first part), HDR
// (Radiance), or PNG (8 or 16 bit; sRGB is decoded by its exact curve, alpha is dropped). One channel becomes three equal ones.
// Throws Error(failed) with file and reason. For any thread.
FloatImage read_picture(const std::string& path);

// The same of a picture in memory, `bytes` as in its file; messages name no file.
FloatImage decode_picture(const std::string& bytes);
// Whether it is a picture of floats: PFM, EXR or HDR. Asks the first bytes alone.
bool holds_floats(const std::string& bytes);
// Width and height as the head of a picture of floats says. Its pixels are not read. Throws as decode_picture() does.
std::array<unsigned, 2> size_of_floats(const std::string& bytes);

}  // namespace clarity
