// camera_control.hpp -- motions of a camera and of a light, for keys and mouse. Pure arithmetic, no window.
#pragma once
#include <array>
#include <glm/vec3.hpp>

#include "rt_types.h"
#include "scene/scene.hpp"

namespace clarity::ui {

using Vec3 = std::array<float, 3>;
inline glm::vec3 vec(const Vec3& a) {
    return {a[0], a[1], a[2]};
}

// Orthonormal axes of a camera.
struct CameraAxes {
    Vec3 right, up, forward;
};
CameraAxes camera_axes(const Camera& camera);

// A step in world units: `right` and `forward` along the camera's axes projected to the ground (the plane perpendicular to
// camera.up), `up` along camera.up. For a camera that looks along -Z, the ground axes are X and Z of the world.
struct Step {
    float right = 0, up = 0, forward = 0;
    bool none() const { return right == 0 && up == 0 && forward == 0; }
};
void move_camera(Camera& camera, const Step& step);
// Moves along the line of sight itself, as other viewers do.
void fly_camera(Camera& camera, const Step& step);
// Turns the camera about its eye. The pitch stays short of straight up and down.
void turn_camera(Camera& camera, float yaw_rad, float pitch_rad);
// Turns the camera about its target.
void orbit_camera(Camera& camera, float yaw_rad, float pitch_rad);
// Moves eye and target together, perpendicular to the line of sight.
void pan_camera(Camera& camera, float right, float up);
// Multiplies the eye's distance from the target by `factor`.
void zoom_camera(Camera& camera, float factor);

// Moves the camera until all of the box is in view. The viewing direction stays.
void frame_bounds(Camera& camera, const Bounds& bounds, float aspect);

// A point light moves by `step` along the camera's ground axes. A directional light turns: the step is added to its direction,
// which is then normalised. size: length of a step that counts as 1 for a direction.
void move_light(rt_light& light, const Camera& camera, const Step& step, float size);

}  // namespace clarity::ui
