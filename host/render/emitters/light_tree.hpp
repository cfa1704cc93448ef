// light_tree.hpp -- a tree over emitters that are somewhere, by which kernels pick one for a point (cl/shading/light_tree.h).
#pragma once
#include <vector>

#include "render/emitters/light_bound.hpp"

namespace clarity {

// The nodes, the root first. Returns nothing for no bounds. leaves: those of emitters, in the order of bounds.
std::vector<rt_light_node> build_light_tree(const std::vector<LightBound>& bounds, std::vector<rt_u32>& leaves);

}  // namespace clarity
