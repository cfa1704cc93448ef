// edit.hpp -- what was changed of a scene's view, in words: the same for presets, command lines and the window.
//
//   camera       ex,ey,ez,tx,ty,tz,fov_deg,ux,uy,uz      background, ambient   r,g,b
//   light.N      off | point,x,y,z,r,g,b | directional,x,y,z,r,g,b             N counts the view's lights from 0; N = their
//                                                                              number adds one
//   material.N.M where M is color, emission or specular (r,g,b), reflect, refract, ior or shininess (a number)
//   hide         instances that are not in the picture: 3,5-9
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "render/frame/renderer.hpp"
#include "scene/scene.hpp"

namespace clarity {

struct Word {
    std::string key, value;
};

// A view that remembers what is switched off in it.
struct EditedView {
    View view;                    // with all lights
    std::vector<bool> lights_on;  // one a light; missing ones are on
    std::vector<rt_u32> hidden;   // instances, ascending
};

// Whether `key` belongs to this vocabulary rather than to the settings table.
bool is_edit(const std::string& key);
// Throws Error(usage): what was read, what is allowed.
void apply_edit(const Scene& scene, EditedView& edited, const std::string& key, const std::string& value);
// The words that turn `base` into `edited`, numbers with all their digits. The camera is always among them.
std::vector<Word> edits_between(const Scene& scene, const View& base, const EditedView& edited);
// As frames take it: without the lights that are off.
View visible_view(const EditedView& edited);
// A copy without these instances' geometry; numbers of instances stay as they are.
Scene without_instances(const Scene& scene, const std::vector<rt_u32>& hidden);

}  // namespace clarity
