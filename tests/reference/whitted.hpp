// whitted.hpp -- the shading model of docs/scene_format.md as a plain recursive tracer, for comparison. It uses double
// precision, has no packets and no queues, and shares no code with cl/.
//
// Whitted 1980, An Improved Illumination Model for Shaded Display; Glassner (ed.) 1989, An Introduction to Ray Tracing.
// It has no textures and refuses scenes with textures.
#pragma once
#include "base/pictures/byte_image.hpp"
#include "base/pictures/image_io.hpp"
#include "scene/scene.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity::reference {

// Renders with the size, depth, min_weight and shadows of `settings`. Returns linear light in 3 channels. Throws
// std::invalid_argument if the scene has textures.
FloatImage render(const Scene& scene, const View& view, const Settings& settings);

// Clips to 0..1, converts to sRGB by its definition (IEC 61966-2-1) and rounds to 8 bits.
ByteImage to_display(const FloatImage& linear);

}  // namespace clarity::reference
