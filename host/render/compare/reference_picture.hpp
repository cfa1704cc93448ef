// reference_picture.hpp -- the picture that another one should come near.
#pragma once
#include <string>

#include "render/film/image_io.hpp"
#include "render/settings/settings.hpp"

namespace clarity {

// Reads the file of --reference. Of a part of a picture it may show the whole one. Throws Error(failed) if it cannot be read;
// with a size that is not the picture's, Error(usage).
FloatImage read_reference(const std::string& file, const Settings& settings);

}  // namespace clarity
