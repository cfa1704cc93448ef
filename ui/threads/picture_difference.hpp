// picture_difference.hpp -- compares two pictures of the same view pixel by pixel.
#pragma once
#include "ui/threads/picture.hpp"

namespace clarity::ui {

// Compares two images of the same size. If the sizes differ, every pixel counts as different and the image is empty.
PictureDifference compare_pictures(const ByteImage& a, const ByteImage& b);

}  // namespace clarity::ui
