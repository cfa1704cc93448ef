// parser.hpp -- from the text of a scene file to a Document.
#pragma once
#include <functional>
#include <string_view>

#include "document.hpp"

namespace scene_format {

// Reads all of it, also behind errors, up to Diagnostics::kMaxErrors. `proceed` hears how far (0..1), and stops the reading by
// returning false; the result is then false and incomplete.
bool parse(std::string_view text, Document& document, Diagnostics& diagnostics, const std::function<bool(float)>& proceed);

}  // namespace scene_format
