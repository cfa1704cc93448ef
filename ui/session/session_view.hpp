// session_view.hpp -- what keys, mouse and panel do to the desired camera and materials.
#pragma once
#include <array>

#include "ui/session/session.hpp"

namespace clarity::ui {

// Moves the camera's target to `point`. The eye's distance to it is multiplied by `nearer`.
void focus_on(DesiredState& desired, const std::array<float, 3>& point, float nearer = 1);
void focus_on_instance(Session& session, rt_u32 instance);
// To a bookmarked view. Its time is shown unless the scene plays.
void go_to(Session& session, const Camera& camera, const PoseTime& pose);
void frame_selection(Session& session);  // frames the selection, or the whole scene if nothing is selected
// The materials to edit. They are copied from the scene to `desired` at the first edit.
MaterialValues& edited_material(Session& session, rt_u32 index);
const MaterialValues& material(const Session& session, rt_u32 index);
// Gives a material another texture of the scene, or none; or a picture of a file, which is read first. Factors that it
// multiplies become 1 where they would hide it.
void give_texture(Session& session, rt_u32 material, rt_u32 use, rt_u32 texture);
void give_picture(Session& session, rt_u32 material, rt_u32 use, const std::string& path);
// Unit for steps of camera and lights: the diagonal of the scene.
float scene_size(const Session& session);

}  // namespace clarity::ui
