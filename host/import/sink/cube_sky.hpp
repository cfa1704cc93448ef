// cube_sky.hpp -- a sky from the six pictures of a cube.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "scene/sky.hpp"

namespace clarity::import {

// A square picture, RGBA8, top row first, as rt_sky_desc::faces has it; or the light itself.
struct CubeFace {
    rt_u32 side = 0;
    bool is_bright = false;  // scene/bright_texture.hpp
    std::vector<uint32_t> texels;
};
using Cube = std::array<CubeFace, 6>;

// Makes the picture of a sky from faces that are all as large. turn: a unit quaternion x, y, z, w. At most 4096 x 2048 texels.
void show_cube(const Cube& cube, const std::array<double, 4>& turn, Sky& sky);

}  // namespace clarity::import
