// size_note.hpp -- what users are told where a tracer shows less than the scene has.
#pragma once
#include <string>

#include "render/view/view.hpp"

namespace clarity {

// "2 lights with a size light as points at their middles; ...", or an empty text. tracer: the setting's value.
std::string size_note(const std::vector<rt_light>& lights, const std::string& tracer);

}  // namespace clarity
