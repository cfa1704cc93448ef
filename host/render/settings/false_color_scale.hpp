// false_color_scale.hpp -- what the false colours of a picture mean.
#pragma once
#include <string>

namespace clarity {

// What the colours of a picture mean, for a colour bar beside it.
struct FalseColorScale {
    enum class Map { none, gray, heat };  // none: a colour says no amount, so there is no bar (color, prim, normal, ...)
    Map map = Map::none;
    float min = 0, max = 1;   // values at the two ends of the bar; beyond them the end's colour
    bool whole = false;       // a count: numbers between are none
    std::string label, unit;  // "Node visits", "per packet"
};

}  // namespace clarity
