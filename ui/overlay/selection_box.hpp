// selection_box.hpp -- the box about what was picked, in world space.
#pragma once
#include <array>
#include <optional>

#include "ui/session/session.hpp"

namespace clarity::ui {

// Corners as Volumes has them. An instance's box lies along its own axes. nullopt: nothing that has bounds. Linear in the
// mesh's vertices.
std::optional<std::array<std::array<float, 3>, 8>> selection_box(const Scene& scene, const Selection& selection);

}  // namespace clarity::ui
