// light_handles.hpp -- lights as things to be dragged in the picture. Pure arithmetic.
//
// A point light is a handle where it is; it moves in the plane across the line of sight, or along its own line of sight. A
// directional light has no place: its handle lies on a disc that unrolls the sphere of directions about the eye (azimuthal
// equidistant: straight ahead in the middle, straight behind at the rim), so that every direction can be reached.
#pragma once
#include <vector>

#include "ui/session/desired_state.hpp"
#include "ui/viewport/projection.hpp"

namespace clarity::ui {

struct LightHandle {
    enum class Kind {
        point,
        sun,
        outside  // a point light that the picture does not show: a mark at the border, in its direction
    };
    unsigned index = 0;
    Kind kind = Kind::point;
    glm::vec2 place{};
    float distance = 0;  // from the eye, of points
};

std::vector<LightHandle> light_handles(const Projection& projection, const std::vector<DesiredLight>& lights);

// So that its handle comes to `place`, as far from the picture's plane as it is.
void drag_point_light(rt_light& light, const Projection& projection, const glm::vec2& place);
// Away from the eye by a factor.
void push_point_light(rt_light& light, const Projection& projection, float factor);
void drag_sun(rt_light& light, const Projection& projection, const glm::vec2& place);

// The disc of directions.
glm::vec2 sun_place(const Projection& projection, const glm::vec3& towards);
glm::vec3 sun_direction(const Projection& projection, const glm::vec2& place);
float sun_disc_radius(const Projection& projection);

}  // namespace clarity::ui
