// picture_digest.hpp -- tells whether two runs render the same picture.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "base/pictures/image_io.hpp"
#include "cli/render/frame_scene.hpp"
#include "stand/multi_preparer.hpp"

namespace clarity {

// Digests of the frames of one scene: 32 hexadecimal digits, from all that a picture depends on: the scene, what options and
// presets change in it, the time, the settings, the kernels' texts and the program's version. They do not depend on paths,
// threads, devices or tiles, nor on how rays are traced: accel, packet and lanes make the same picture, apart from quantities
// that say what tracing cost. Tracers make the same picture if they say so (TracerChoice::picture). Used from one thread.
class PictureDigests {
 public:
    // scene: imported; it must outlive this. options.output: its format decides whether tone mapping counts. Throws Error if a
    // kernel cannot be read.
    PictureDigests(FrameScene& scene, const Settings& settings, const RenderOptions& options);
    // frame: its number, if frames differ (FrameScene::follows_frames()). Throws Error if a file of a sequence cannot be read.
    const std::string& of(std::optional<int> frame);

 private:
    FrameScene& scene_;
    std::string common_;  // of all that is the same in all frames
    std::map<std::optional<int>, std::string> known_;
};

// What decides the last bits of a picture besides: devices and drivers, structure, tracer and the text of the kernel.
std::string way_of_tracing(const std::vector<DeviceInfo>& devices, const MultiPrepared& prepared);

// Of the pixels themselves, whatever the file around them says.
std::string pixel_digest(const FloatImage& image);
std::string pixel_digest(const ByteImage& image);

}  // namespace clarity
