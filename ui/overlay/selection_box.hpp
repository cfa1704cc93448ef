// selection_box.hpp -- the box around the selected object, in world space.
#pragma once
#include <array>
#include <optional>

#include "ui/session/session.hpp"

namespace clarity::ui {

// A box along an object's own axes.
struct SelectionBox {
    Bounds own;  // not empty
    Affine place = kIdentity;
    std::array<std::array<float, 3>, 8> corners() const;  // in the order of Volumes
};

// nullopt: the selection has no bounds. vertices: those of the selected instance's mesh, where the scene does not have them.
// Takes time linear in the mesh's vertices.
std::optional<SelectionBox> selection_box(const Scene& scene, const Selection& selection, const PosedMesh* vertices = nullptr);

}  // namespace clarity::ui
