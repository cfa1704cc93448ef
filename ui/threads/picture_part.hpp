// picture_part.hpp -- a part of the picture that alone is traced, and its place in the whole.
#pragma once
#include <string>

#include "base/pictures/byte_image.hpp"
#include "base/pictures/float_image.hpp"
#include "view/settings/settings.hpp"

namespace clarity::ui {

// In shares of the whole picture, from the top left.
struct PicturePart {
    float x = 0, y = 0, width = 1, height = 1;
    bool operator==(const PicturePart& o) const { return x == o.x && y == o.y && width == o.width && height == o.height; }
    bool operator!=(const PicturePart& o) const { return !(*this == o); }
};

// The part as `--crop` takes it, of a picture of this size: whole pixels, at least one.
std::string crop_text(const PicturePart& part, int width, int height);

// Settings of the whole picture, given those of a part (crop_picture()).
Settings of_whole(Settings settings);
// The whole picture with a traced part, of such settings. around: the whole as it was, which is shown darker; of another size:
// nothing is known of it.
ByteImage in_whole(const ByteImage& part, const Settings& settings, const ByteImage& around);
// The same of values; `outside` stands where nothing was traced.
FloatImage in_whole(const FloatImage& part, const Settings& settings, float outside);
// The traced part of such a picture; all of it, if it is no part.
ByteImage cropped(const ByteImage& whole, const Settings& settings);

}  // namespace clarity::ui
