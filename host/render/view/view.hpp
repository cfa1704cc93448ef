// view.hpp -- what may change from frame to frame: the camera, the lights, the materials and the background.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity {

// The camera, lights, materials and background of a frame. They may change from frame to frame without a new prepare().
struct View {
    Camera camera;
    std::vector<rt_light> lights;
    // One for each material of the scene; empty: use the scene's own. Textures are the scene's in any case.
    std::vector<MaterialValues> materials;
    std::array<float, 3> background{}, ambient{};
    std::optional<SkyValues> sky;  // empty: the scene's own
};
// The material of that number in a view of the scene.
inline const MaterialValues& material_of(const Scene& scene, const View& view, size_t number) {
    return view.materials.empty() ? scene.materials[number].values : view.materials[number];
}
inline const SkyValues& sky_of(const Scene& scene, const View& view) {
    return view.sky ? *view.sky : scene.sky.values;
}
// Makes a view from the scene's camera, lights, ambient light and background. If the scene has no lights, it gets two that suit
// its size.
// camera: "" (the scene's first camera, or one that frames the scene), a camera's name, or "ex,ey,ez,tx,ty,tz[,fov_deg]".
// light: "" or "x,y,z", which moves the first light, and makes it a point light if it lies in a direction. Throws Error(usage)
// if it cannot read either.
View make_view(const Scene& scene, float aspect, const std::string& camera = {}, const std::string& light = {});

}  // namespace clarity
