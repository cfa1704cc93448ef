// crop.hpp -- a part of a picture, which has the pixels that it has in the whole.
#pragma once
#include <string>

namespace clarity {

struct Settings;

// Where a picture lies in a whole one. 0x0: it is the whole.
struct Crop {
    int x = 0, y = 0;  // its first pixel, from the top left
    int whole_width = 0, whole_height = 0;
};

// "x,y,width,height" in pixels of the picture of settings.width x settings.height, of which the settings are then for that
// part. Throws Error(usage), as "--crop 0,0,9,9: ...", if it is no such text or not within the picture.
void crop_picture(Settings& settings, const std::string& text);

}  // namespace clarity
