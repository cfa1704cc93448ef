// moving_frames.hpp -- whole frames of a scene that moves on the device. Either all vertices move: a wave is computed there, or
// what the scene's own clip deforms; the structure is refitted or built there, and the picture is traced. Or one small object
// moves beside the scene.
#pragma once
#include <memory>

#include "launch/prepared.hpp"
#include "moving/on_device/device_mover.hpp"
#include "stand/multi_frame_renderer.hpp"
#include "tools/bench/run/measure.hpp"

namespace clarity::bench {

class MovingFrames {
 public:
    // clip_sent: as clip_refitted, but the host makes the vertices and sends them.
    enum class Motion { wave_refitted, wave_built, object, nothing, clip_refitted, clip_built, clip_sent };

    // Throws Error(usage) if the structure cannot follow, or cannot be built there, or the scene has no clip.
    MovingFrames(const PluginRegistry& plugins, std::shared_ptr<Device> device, const Scene& scene, const Settings& settings,
                 const View& view, Motion motion, Progress& progress);

    // Shows some frames one after the other. Times are the mean of a frame: kernels by the device's clock, and all by the
    // host's. Nothing is sent to the device but the phase of the wave, the place of the object, or what a pose of the clip
    // needs, and nothing comes back but the end of the frame.
    Sample play(Progress& progress);

    // Milliseconds of a frame, medians over the calls of play(): "deform", "update", "trace"; of a clip "pose" by the host's
    // clock, and "update" with the vertices.
    Parts parts() const;
    const Prepared& prepared() const { return *prepared_->first(); }

 private:
    cl::Event deform(float phase);
    bool plays_clip() const { return kind_ >= Motion::clip_refitted; }
    bool builds() const { return kind_ == Motion::wave_built || kind_ == Motion::clip_built; }
    std::shared_ptr<const Scene> staged(const Scene& scene) const;
    Pose pose_of(float phase) const;
    Pose clip_pose(unsigned frame) const;
    MovedOnDevice move(float phase);

    const std::shared_ptr<Device> device_;
    const Settings settings_;
    const View view_;
    const Motion kind_;
    std::shared_ptr<const Scene> rest_scene_;  // of a clip: with its motion
    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const MultiPrepared> prepared_;
    std::unique_ptr<DeviceMover> motion_;
    BuildKernels kernels_;
    cl::Kernel wave_;
    cl::Buffer rest_;
    MultiFrameRenderer frames_;
    float size_ = 0;  // of the scene
    unsigned next_ = 0;
    std::vector<double> pose_ms_, deform_ms_, update_ms_, trace_ms_;
};

}  // namespace clarity::bench
