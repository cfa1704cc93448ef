// sky.hpp -- the statement `sky`, and its edits. Its reference is docs/scene_format.md.
#pragma once
#include "statement.hpp"

namespace scene_format {

void read_sky(Statement& s, Document& document, Diagnostics& diagnostics);
void read_sky_edits(Statement& s, Document& document);  // the rest of `edit sky`

}  // namespace scene_format
