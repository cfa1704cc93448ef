// picture_difference.hpp -- two pictures of the same view, compared pixel by pixel.
#pragma once
#include "ui/session/frame_thread.hpp"

namespace clarity::ui {

// Of the same size; else everything differs, and the image is empty.
PictureDifference compare_pictures(const ByteImage& a, const ByteImage& b);

}  // namespace clarity::ui
