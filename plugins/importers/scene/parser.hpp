// parser.hpp -- parses the text of a scene file into a Document.
#pragma once
#include <functional>
#include <string_view>

#include "document.hpp"

namespace scene_format {

using ShapeKinds = std::vector<const rt_primitive_kind*>;

// Reads the whole text and continues after errors, up to Diagnostics::kMaxErrors. Calls `proceed` with the fraction that is
// done (0..1). If `proceed` returns false, parsing stops and the function returns false; the document is then incomplete.
// Otherwise it returns true, also if there were errors.
bool parse(std::string_view text, const ShapeKinds& kinds, Document& document, Diagnostics& diagnostics,
           const std::function<bool(float)>& proceed);

}  // namespace scene_format
