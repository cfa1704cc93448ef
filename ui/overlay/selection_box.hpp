// selection_box.hpp -- the box around the selected object, in world space.
#pragma once
#include <array>
#include <optional>

#include "ui/session/session.hpp"

namespace clarity::ui {

// Returns the corners in the order of Volumes. The box of an instance lies along its own axes. nullopt: the selection has no
// bounds. Takes time linear in the mesh's vertices.
std::optional<std::array<std::array<float, 3>, 8>> selection_box(const Scene& scene, const Selection& selection);

}  // namespace clarity::ui
