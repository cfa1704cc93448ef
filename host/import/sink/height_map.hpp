// height_map.hpp -- pictures of heights (bump maps) as maps of normals.
#pragma once
#include <cstdint>

#include "rt_types.h"

namespace clarity::import {

// Turns a grey picture of heights, of width x height texels, into a map of normals: see RT_SPACE_HEIGHT. A picture of other
// colours is one already, and stays as it is.
void make_normals(uint32_t* texels, const rt_texture& picture);

}  // namespace clarity::import
