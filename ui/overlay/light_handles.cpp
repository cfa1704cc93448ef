#include "ui/overlay/light_handles.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/angle.hpp"
#include "scene/light_kinds.hpp"

namespace clarity::ui {
namespace {

constexpr auto kHalfTurn = static_cast<float>(kPi);

glm::vec3 position_of(const rt_light& light) {
    return {light.position[0], light.position[1], light.position[2]};
}
void set_position(rt_light& light, const glm::vec3& position) {
    for (int i = 0; i < 3; ++i) light.position[i] = position[i];
}

glm::vec2 middle(const Rect& area) {
    return {area.x + area.width / 2, area.y + area.height / 2};
}

// The point, a little inside the area's border, in direction `away` from its centre.
glm::vec2 at_border(const Rect& area, glm::vec2 away) {
    if (glm::length(away) < 1e-6f) away = {0, 1};
    constexpr float kInside = 0.95f;
    const float x = area.width / 2 * kInside / std::max(std::abs(away.x), 1e-6f),
                y = area.height / 2 * kInside / std::max(std::abs(away.y), 1e-6f);
    return middle(area) + away * std::min(x, y);
}

}  // namespace

float sun_disc_radius(const Projection& projection) {
    return 0.45f * std::min(projection.area().width, projection.area().height);
}

glm::vec2 sun_place(const Projection& projection, const glm::vec3& towards) {
    const glm::vec3 c = projection.to_camera(projection.eye() + towards);
    const float across = std::hypot(c.x, c.y), angle = std::atan2(across, c.z);
    const glm::vec2 away = across > 1e-6f ? glm::vec2(c.x, -c.y) / across : glm::vec2(0, -1);
    return middle(projection.area()) + away * (angle / kHalfTurn * sun_disc_radius(projection));
}

glm::vec3 sun_direction(const Projection& projection, const glm::vec2& place) {
    const glm::vec2 offset = (place - middle(projection.area())) / std::max(sun_disc_radius(projection), 1e-6f);
    const float length = glm::length(offset), angle = std::min(length, 1.0f) * kHalfTurn;
    const glm::vec2 away = length > 1e-6f ? offset / length : glm::vec2(0, -1);
    const float sine = std::sin(angle);
    const glm::vec3 direction = projection.to_world({away.x * sine, -away.y * sine, std::cos(angle)}) - projection.eye();
    return glm::normalize(direction);
}

std::vector<LightHandle> light_handles(const Projection& projection, const std::vector<DesiredLight>& lights) {
    std::vector<LightHandle> handles;
    const Rect& area = projection.area();
    for (unsigned i = 0; i < lights.size(); ++i) {
        const rt_light& light = lights[i].values;
        LightHandle handle;
        handle.index = i;
        if (!light_kind_of(light).has_place) {
            handle.kind = LightHandle::Kind::sun;
            handle.place = sun_place(projection, position_of(light));
        } else {
            const glm::vec3 c = projection.to_camera(position_of(light));
            handle.distance = glm::length(c);
            if (c.z >= projection.near()) handle.place = projection.to_window(c);
            if (c.z < projection.near() || !area.holds(handle.place.x, handle.place.y)) {
                handle.kind = LightHandle::Kind::outside;
                handle.place = at_border(area, {c.x, -c.y});
            }
        }
        handles.push_back(handle);
    }
    return handles;
}

void drag_point_light(rt_light& light, const Projection& projection, const glm::vec2& place) {
    const float depth = projection.to_camera(position_of(light)).z;
    if (!(depth >= projection.near())) return;
    const float unit = projection.unit_at(depth);
    const glm::vec2 offset = place - middle(projection.area());
    set_position(light, projection.to_world({offset.x * unit, -offset.y * unit, depth}));
}

void push_point_light(rt_light& light, const Projection& projection, float factor) {
    set_position(light, projection.eye() + (position_of(light) - projection.eye()) * factor);
}

void drag_sun(rt_light& light, const Projection& projection, const glm::vec2& place) {
    set_position(light, sun_direction(projection, place));
}

}  // namespace clarity::ui
