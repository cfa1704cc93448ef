// camera_control.hpp -- how keys and mouse move a camera and a light. Pure arithmetic, no window.
#pragma once
#include <array>

#include "rt_types.h"
#include "scene/scene.hpp"

namespace clarity::ui {

using Vec3 = std::array<float, 3>;

// Orthonormal axes of a camera (DESIGN: w = forward, u = right, v = its own up).
struct CameraAxes {
    Vec3 right, up, forward;
};
CameraAxes camera_axes(const Camera& camera);

// Amounts along the camera's axes laid onto the ground (the plane across camera.up), and along camera.up; world units. For a
// camera that looks along -Z this is the world's X and Z.
struct Step {
    float right = 0, up = 0, forward = 0;
    bool none() const { return right == 0 && up == 0 && forward == 0; }
};
void move_camera(Camera& camera, const Step& step);
// Along the line of sight itself, as one walks in a viewer.
void fly_camera(Camera& camera, const Step& step);
// About the eye; pitch stops short of straight up and down.
void turn_camera(Camera& camera, float yaw_rad, float pitch_rad);
// About the target.
void orbit_camera(Camera& camera, float yaw_rad, float pitch_rad);
// Eye and target shift together across the view.
void pan_camera(Camera& camera, float right, float up);
// Towards the target: factor < 1 nears it.
void zoom_camera(Camera& camera, float factor);

// All of the box comes into view, along the line of sight that the camera has.
void frame_bounds(Camera& camera, const Bounds& bounds, float aspect);

// A point light moves like the camera, in the camera's ground axes; a directional one swings: its direction is moved and
// brought back to unit length, `size` being the length that stands for one unit.
void move_light(rt_light& light, const Camera& camera, const Step& step, float size);

}  // namespace clarity::ui
