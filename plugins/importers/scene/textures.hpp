// textures.hpp -- the statement `texture`, and what it means for a material.
#pragma once
#include "document.hpp"
#include "rt_plugin.h"
#include "statement.hpp"

namespace scene_format {

void read_texture(Statement& s, Document& document, Diagnostics& diagnostics);
// One wrap mode for both directions, or two.
void read_wrap(Statement& s, rt_u32& along_u, rt_u32& along_v);
// How a texture is used. id: that of the sink.
rt_map_desc map_of(const Texture& texture, rt_u32 use, rt_u32 id);

// The statement `sky`, and its edits. Its reference is docs/scene_format.md.
void read_sky(Statement& s, Document& document, Diagnostics& diagnostics);
void read_sky_edits(Statement& s, Document& document);  // the rest of `edit sky`

}  // namespace scene_format
