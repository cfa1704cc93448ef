// picture.hpp -- the samples of a height map: PNG of 8 and 16 bits, PGM as text and binary.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "rt_plugin.h"

namespace heightfield {

struct Picture {
    rt_u32 width = 0, height = 0;
    std::vector<float> samples;  // shares of the largest value that the file can hold, row by row from the top
    std::string left_out;        // what the file has besides; empty: nothing
};

// Reads the file by its first bytes. Throws std::runtime_error with the reason (without the file's name).
Picture read_picture(std::string_view bytes);

}  // namespace heightfield
