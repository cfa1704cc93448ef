// sky.hpp -- the statement `sky`. Its reference is docs/scene_format.md.
#pragma once
#include "statement.hpp"

namespace scene_format {

void read_sky(Statement& s, Document& document, Diagnostics& diagnostics);

}  // namespace scene_format
