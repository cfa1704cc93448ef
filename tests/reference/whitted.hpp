// whitted.hpp -- the shading model of docs/scene_format.md as a plain recursive tracer, for comparison: double precision, no
// packets, no queues, nothing shared with cl/.
//
// Whitted 1980, An Improved Illumination Model for Shaded Display; Glassner (ed.) 1989, An Introduction to Ray Tracing.
// Textures are not in it: scenes that have some are refused.
#pragma once
#include "render/film/image_io.hpp"
#include "render/frame/renderer.hpp"

namespace clarity::reference {

// `settings` gives size, depth, min_weight and shadows. Linear light, 3 channels. Throws std::invalid_argument for textures.
FloatImage render(const Scene& scene, const View& view, const Settings& settings);

// Clipped to 0..1, in sRGB by its definition (IEC 61966-2-1), rounded to 8 bits.
ByteImage to_display(const FloatImage& linear);

}  // namespace clarity::reference
