#include "render/view/size_note.hpp"

#include <algorithm>

#include "render/settings/tracer_choice.hpp"
#include "scene/light_kinds.hpp"

namespace clarity {

std::string size_note(const std::vector<rt_light>& lights, const std::string& tracer) {
    const auto count = std::count_if(lights.begin(), lights.end(), [](const rt_light& l) { return light_kind_of(l).has_size; });
    if (count == 0 || picture_of_tracer(tracer) != kWhittedPicture) return {};
    return std::to_string(count) +
           (count == 1 ? " light with a size lights as a point at its middle"
                       : " lights with a size light as points at their middles") +
           ", without soft shadows, because the tracer `" + tracer + "` shades as Whitted does";
}

}  // namespace clarity
