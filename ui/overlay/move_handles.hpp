// move_handles.hpp -- handles with which an instance is moved, turned and scaled in the picture. Pure arithmetic.
//
// Arrows along the world's axes move along them, the disc in the middle moves across the view, a ring about an axis turns, and
// the square scales. All have the same size in the window, wherever the instance is.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "scene/instance_edit.hpp"
#include "ui/overlay/projection.hpp"
#include "ui/session/session.hpp"

namespace clarity::ui {

enum class MoveHandle { none = -1, x, y, z, view, turn_x, turn_y, turn_z, scale };
inline constexpr int kMoveHandles = 8;
inline constexpr const char* kMoveHandleNames[] = {"move x", "move y", "move z", "move", "turn x", "turn y", "turn z", "scale"};

// Where the handles of a point of the world are, in window coordinates.
struct MoveHandles {
    glm::vec3 middle{};  // in the world
    float length = 0;    // of an arrow, in the world
    glm::vec2 centre{};  // of the disc, in the window
    // The lines of each handle. Arrows: from the disc to the tip. Rings: their front halves. Those that would be a point, or a
    // line, are empty: they cannot be dragged from here.
    std::array<std::vector<glm::vec2>, kMoveHandles> lines;
};

// scale: of the window's text and widgets. nullopt: the point is behind the eye.
std::optional<MoveHandles> move_handles(const Projection& projection, const glm::vec3& middle, float scale);
// The handle at a place of the window.
MoveHandle handle_at(const MoveHandles& handles, const glm::vec2& mouse, float scale);
// Where to grab a handle with the mouse; nullopt: it is not shown.
std::optional<glm::vec2> grab_place(const MoveHandles& handles, MoveHandle handle);

// A drag of a handle, from the place where the mouse was pressed to where it is now.
struct MoveDrag {
    MoveHandle handle = MoveHandle::none;
    glm::vec2 from{};
    glm::vec3 middle{};   // of the instance in the world, when the mouse was pressed
    InstanceShift start;  // at that time
};
// The shift of the instance now. The start's, where the view shows the handle's axis as a point.
InstanceShift dragged(const MoveDrag& drag, const Projection& projection, const glm::vec2& mouse);

// The box around the selected object, in world space.

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
