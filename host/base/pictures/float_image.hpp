// float_image.hpp -- a picture of floats in memory.
#pragma once
#include "base/aligned_bytes.hpp"

namespace clarity {

// Not cleared when they are made: of a large picture that takes longer than to copy it from a GPU.
using FloatPixels = UninitializedVector<float>;
// width x height pixels of `channels` floats each, top row first.
struct FloatImage {
    unsigned width = 0, height = 0, channels = 0;
    FloatPixels pixels;
};

}  // namespace clarity
