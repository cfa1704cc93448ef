// picture_read.hpp -- reads pictures that are to be compared.
#pragma once
#include <string>

#include "render/film/image_io.hpp"

namespace clarity {

// Reads a picture of colours as linear values, top row first: PFM (1 or 3 channels), EXR (R, G, B or Y of the first part), or
// PNG (8 or 16 bit; sRGB is decoded by its exact curve, alpha is dropped). One channel becomes three equal ones. Throws
// Error(failed) with file and reason. For any thread.
FloatImage read_picture(const std::string& path);

}  // namespace clarity
