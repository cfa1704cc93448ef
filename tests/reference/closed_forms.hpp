// closed_forms.hpp -- scenes whose light is known by a formula: what every path tracer must meet, the reference first of all.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "scene/vec.hpp"
#include "view/view.hpp"

namespace clarity::reference {

struct ClosedForm {
    std::string group, name;  // groups: "furnaces", "lights", "skies", "rooms", "glass"
    Scene scene;
    View view;       // a picture whose mean is `expected`; mostly of one point
    unsigned depth;  // scattering events
    Vec expected;
    double rounding = 1e-5;  // of `expected`, and of the picture's size around the point
    int bounce = -1;         // light of so many events only; -1: all
    bool varies = false;     // pixels show different points: their spread is not noise
    double largest = 0;      // of all forms that are expected together, as rows of one table
};

std::vector<ClosedForm> closed_forms();

}  // namespace clarity::reference
