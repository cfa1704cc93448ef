#include "render/compare/reference_picture.hpp"

#include "base/error.hpp"
#include "base/pictures/picture_read.hpp"

namespace clarity {
namespace {

FloatImage part_of(const FloatImage& whole, int first_x, int first_y, int width, int height) {
    FloatImage part;
    part.width = unsigned(width);
    part.height = unsigned(height);
    part.channels = whole.channels;
    const auto at = [&](int row) {
        return whole.pixels.begin() + (ptrdiff_t(first_y + row) * whole.width + first_x) * ptrdiff_t(whole.channels);
    };
    for (int row = 0; row < height; ++row)
        part.pixels.insert(part.pixels.end(), at(row), at(row) + ptrdiff_t(width) * ptrdiff_t(whole.channels));
    return part;
}

}  // namespace

FloatImage read_reference(const std::string& file, const Settings& settings) {
    FloatImage picture = read_picture(file);
    const auto text = [](auto width, auto height) { return std::to_string(width) + "x" + std::to_string(height); };
    const Crop& crop = settings.crop;
    if (crop.whole_width > 0 && int(picture.width) == crop.whole_width && int(picture.height) == crop.whole_height)
        picture = part_of(picture, crop.x, crop.y, settings.width, settings.height);
    const std::string size = text(picture.width, picture.height), wanted = text(settings.width, settings.height);
    if (size != wanted)
        throw Error(Exit::usage,
                    "--reference " + file + ": has " + size + " pixels and the picture " + wanted + "; take --size " + size);
    return picture;
}

}  // namespace clarity
