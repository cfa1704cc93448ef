// edit.hpp -- changes to a scene's view as text. Presets, command lines and the window use the same words.
//
//   camera       ex,ey,ez,tx,ty,tz,fov_deg,ux,uy,uz      background, ambient   r,g,b
//   light.N      off | point,x,y,z,r,g,b | directional,x,y,z,r,g,b             N counts the view's lights from 0; N = their
//                                                                              number adds one
//   camera_path  t:camera;t:camera;...: the camera at times of the clip; see camera_path.hpp
//   material.N.M where M is color, emission or specular (r,g,b), reflect, refract, ior or shininess (a number)
//   hide         instances that the picture leaves out: 3,5-9
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "render/settings/camera_path.hpp"
#include "render/settings/view.hpp"
#include "scene/scene.hpp"

namespace clarity {

// One edit: "light.0", "off".
struct Word {
    std::string key, value;
};

// A view, and the lights and instances that are switched off in it.
struct EditedView {
    View view;                    // with all lights, including those that are off
    std::vector<bool> lights_on;  // one for each light; missing ones are on
    std::vector<rt_u32> hidden;   // instances, in ascending order
    CameraPath camera_path{};
    bool follows_path = false;  // the camera was not set after the path
};

// Whether `key` is an edit. Other keys belong to the settings table.
bool is_edit(const std::string& key);
// Applies an edit. Throws Error(usage), which says what was read and what is allowed.
void apply_edit(const Scene& scene, EditedView& edited, const std::string& key, const std::string& value);
// Returns the edits that turn `base` into `edited`. Numbers have all their digits. The camera is always included, or
// its path if it follows one.
std::vector<Word> edits_between(const Scene& scene, const View& base, const EditedView& edited);
// Returns the view to trace: without the lights that are off.
View visible_view(const EditedView& edited);
// Returns a copy in which these instances are invisible. The other instances keep their numbers.
Scene without_instances(const Scene& scene, const std::vector<rt_u32>& hidden);

}  // namespace clarity
