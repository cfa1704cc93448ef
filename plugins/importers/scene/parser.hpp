// parser.hpp -- parses the text of a scene file into a Document.
#pragma once
#include <functional>
#include <string_view>

#include "document.hpp"

namespace scene_format {

// Reads the whole text, by the kinds that the document has, and continues after errors, up to Diagnostics::kMaxErrors. Calls
// `proceed` with the fraction that is done (0..1). If `proceed` returns false, parsing stops and the function returns false;
// the document is then incomplete. Otherwise it returns true, also if there were errors.
bool parse(std::string_view text, Document& document, Diagnostics& diagnostics, const std::function<bool(float)>& proceed);

}  // namespace scene_format
