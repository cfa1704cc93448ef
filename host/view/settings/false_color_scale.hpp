// false_color_scale.hpp -- the meaning of a picture's false colours.
#pragma once
#include <string>

namespace clarity {

// The data of a colour bar.
struct FalseColorScale {
    // none: colours do not stand for amounts, so there is no bar (color, prim, normal, ...).
    enum class Map { none, gray, heat };
    Map map = Map::none;
    float min = 0, max = 1;   // values at the two ends of the bar; values beyond them get the end's colour
    bool whole = false;       // the quantity is a count: only whole numbers occur
    std::string label, unit;  // "Node visits", "per packet"
};

}  // namespace clarity
