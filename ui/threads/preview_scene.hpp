// preview_scene.hpp -- a ball of one material on a chequered floor, under a soft sky and a lamp.
#pragma once
#include "scene/scene.hpp"

namespace clarity::ui {

inline constexpr rt_u32 kPreviewMaterial = 1;  // its number in the scene

// of: the scene that has the material. Of its textures only those of the material are copied, from their first picture that is
// small enough on.
Scene preview_scene(const Scene& of, rt_u32 material);

}  // namespace clarity::ui
