// picture_digest.hpp -- tells whether two runs render the same picture.
#pragma once
#include <optional>
#include <string>

#include "cli/render/frame_scene.hpp"
#include "render/film/image_io.hpp"
#include "render/multi/multi_preparer.hpp"

namespace clarity {

// 32 hexadecimal digits, from all that a frame's picture depends on: the scene, what options and presets change in it, the
// time, the settings, the kernels' texts and the program's version. It does not depend on paths, threads, devices or tiles, nor
// on how rays are traced: accel, tracer, packet and lanes make the same picture, apart from quantities that say what tracing
// cost. scene: imported. frame: a number if frames differ (FrameScene::follows_frames()). output: its format decides whether
// tone mapping counts. Throws Error if a kernel or a file of a sequence cannot be read.
std::string picture_digest(FrameScene& scene, const Settings& settings, std::optional<int> frame, const std::string& output);

// What decides the last bits of a picture besides: devices and drivers, structure, tracer and the text of the kernel.
std::string way_of_tracing(const std::vector<DeviceInfo>& devices, const Prepared& prepared);

// Of the pixels themselves, whatever the file around them says.
std::string pixel_digest(const FloatImage& image);
std::string pixel_digest(const ByteImage& image);

}  // namespace clarity
