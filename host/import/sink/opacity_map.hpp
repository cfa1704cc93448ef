// opacity_map.hpp -- pictures of an opacity that is not their red channel.
#pragma once
#include <cstdint>

#include "rt_types.h"

namespace clarity::import {

// Puts the opacity into all channels of the texels of a picture. space: RT_SPACE_ALPHA or RT_SPACE_CLEARNESS, as rt_plugin.h
// says.
void make_opacities(uint32_t* texels, const rt_texture& picture, uint32_t space);

}  // namespace clarity::import
