#include "render/compare/reference_picture.hpp"

#include "base/error.hpp"
#include "base/pictures/picture_read.hpp"

namespace clarity {

FloatImage read_reference(const std::string& file, const Settings& settings) {
    FloatImage picture = read_picture(file);
    const auto text = [](auto width, auto height) { return std::to_string(width) + "x" + std::to_string(height); };
    const std::string size = text(picture.width, picture.height), wanted = text(settings.width, settings.height);
    if (size != wanted)
        throw Error(Exit::usage,
                    "--reference " + file + ": has " + size + " pixels and the picture " + wanted + "; take --size " + size);
    return picture;
}

}  // namespace clarity
