#include "view/settings/crop.hpp"

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

void crop_picture(Settings& settings, const std::string& text) {
    const std::vector<int> n = read_numbers<int>(text);
    const auto within = [](int first, int count, int all) {
        return first >= 0 && count > 0 && count <= all && first <= all - count;
    };
    if (n.size() != 4 || !within(n[0], n[2], settings.width) || !within(n[1], n[3], settings.height))
        throw Error(Exit::usage,
                    "--crop " + text +
                        ": expected x,y,width,height in pixels from the top left, as in 100,50,64,64, within the picture of " +
                        std::to_string(settings.width) + "x" + std::to_string(settings.height));
    settings.crop = {n[0], n[1], settings.width, settings.height};
    settings.width = n[2];
    settings.height = n[3];
}

}  // namespace clarity
