// light_handles.hpp -- handles with which lights are dragged in the picture. Pure arithmetic.
//
// A light that is somewhere has its handle there, one with a size at its middle. It moves in the plane perpendicular to the
// line of sight, or along its own line of sight. A light that lies in a direction has no position. Its handle lies on a disc
// that shows the sphere of directions about the eye (azimuthal equidistant projection: straight ahead in the middle, straight
// behind at the rim), so that every direction can be reached.
#pragma once
#include <vector>

#include "ui/overlay/projection.hpp"
#include "ui/threads/desired_state.hpp"

namespace clarity::ui {

// A light's handle. `place` is in window coordinates.
struct LightHandle {
    enum class Kind {
        point,
        sun,
        outside  // a light outside of the picture: a mark at the border, in its direction
    };
    unsigned index = 0;
    Kind kind = Kind::point;
    glm::vec2 place{};
    float distance = 0;  // from the eye; for lights with a position
};

std::vector<LightHandle> light_handles(const Projection& projection, const std::vector<DesiredLight>& lights);

// Moves the light so that its handle is at `place`. Its depth from the camera stays the same.
void drag_point_light(rt_light& light, const Projection& projection, const glm::vec2& place);
// Multiplies the light's distance from the eye by `factor`.
void push_point_light(rt_light& light, const Projection& projection, float factor);
void drag_sun(rt_light& light, const Projection& projection, const glm::vec2& place);

// The disc of directions: the position of a direction on it, the direction of a position, and its radius in window units.
glm::vec2 sun_place(const Projection& projection, const glm::vec3& towards);
glm::vec3 sun_direction(const Projection& projection, const glm::vec2& place);
float sun_disc_radius(const Projection& projection);

}  // namespace clarity::ui
