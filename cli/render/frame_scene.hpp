// frame_scene.hpp -- the scene and the view of each frame that `clarity render` traces.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "cli/commands.hpp"
#include "import/import.hpp"
#include "stand/motion_blur.hpp"

namespace clarity {

class Digest;

class FrameScene {
 public:
    FrameScene(const PluginRegistry& plugins, const RenderOptions& options, const TraceWords& words, Progress& progress);

    // What was imported. nullptr: nothing yet.
    void take(std::shared_ptr<const Scene> imported);
    const std::shared_ptr<const Scene>& imported() const { return imported_; }
    // Whether frames show the scene at times of their own.
    bool follows_frames() const;
    // Adds all that the scene and the view of a frame depend on, for picture_digest.hpp. Needs no place(), and poses nothing
    // unless the scene has sequences of files, which are then read.
    void describe(Digest& digest, std::optional<int> frame);
    // Takes the scene at the time of a frame, or at the one that the options name.
    void place(std::optional<int> frame);
    bool placed() const { return scene_ != nullptr; }

    const std::shared_ptr<const Scene>& scene() const { return scene_; }
    const View& view() const { return view_; }
    // The view of a sample of a picture with motion blur: the camera follows its path.
    View view(const MotionBlur::Sample& sample) const;
    // For pictures with motion blur; nullptr: all samples are at one time. prepared: of scene(). preparer: must outlive the
    // result.
    std::unique_ptr<MotionBlur> blur(std::shared_ptr<const MultiPrepared> prepared, MultiPreparer& preparer);

 private:
    PoseOptions pose_of(std::optional<int> frame) const;

    const RenderOptions& options_;
    const TraceWords& words_;
    const PoseOptions pose_;
    const bool has_path_;  // for a camera
    import::SequenceReader sequences_;
    // As imported; with its instances edited; as shown.
    std::shared_ptr<const Scene> imported_, rest_, scene_;
    std::string digest_;            // of imported_; empty: not yet known
    std::optional<double> time_s_;  // of scene_; none: at rest
    std::string clip_;
    CameraPath path_;  // of the camera; empty: it follows none
    View view_;
};

}  // namespace clarity
