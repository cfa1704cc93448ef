// view.hpp -- what may change from frame to frame: the camera, the lights, the materials and the background.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/angle.hpp"
#include "scene/scene.hpp"
#include "view/settings/settings.hpp"

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

// What users are told where a tracer shows less than the scene has.

// "2 lights with a size light as points at their middles; ...", or an empty text. tracer: the setting's value.
std::string size_note(const std::vector<rt_light>& lights, const std::string& tracer);

// A camera as text: ex,ey,ez,tx,ty,tz,fov_deg,ux,uy,uz[,aperture,focus]. Shorter forms leave out the up
// vector, or the field of view as well.

// Text has the coordinates of files, whose differences from Scene::origin are those of the scene.
std::array<float, 3> scene_point(const std::array<double, 3>& in_file, const std::array<double, 3>& origin);
// Three numbers with all their digits. between: what stands between them.
std::string point_text(const float* in_scene, const std::array<double, 3>& origin, const char* between);

struct CameraNumbers {
    std::array<double, 3> eye{}, target{};  // in the coordinates of files
    std::optional<double> fov_deg;          // double: radians must survive the conversion to degrees and back exactly
    std::optional<std::array<float, 3>> up;
    float aperture = 0, focus = 0;  // of the lens
};
// Returns nothing unless the text is 6, 7, 10 or 12 finite numbers with commas between them. Does not check their values.
std::optional<CameraNumbers> read_camera_numbers(const std::string& text);
// All numbers, with all their digits; those of the lens if there is one.
std::string camera_text(const Camera& camera, const std::array<double, 3>& origin = {});
// "  aperture .02  focus 7" for a text scene, or an empty text for a pinhole.
std::string lens_words(const Camera& camera);

// Which kinds of lights and surfaces a view has.

// Those of the scene's own view.
Optics optics_of(const Scene& scene);
// Those of a view, as far as kernels of these settings' tracer tell them apart.
Optics optics_of(const Scene& scene, const View& view, const Settings& settings);
// Whether kernels that were prepared for the scene with these settings know those of the view.
bool knows(const Settings& prepared, const Scene& scene, const View& view);
// Settings for a scene that will be traced with that view.
Settings with_optics(Settings settings, const Scene& scene, const View& view);

}  // namespace clarity
