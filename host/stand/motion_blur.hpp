// motion_blur.hpp -- pictures of which each sample is traced in the pose of its own time.
//
//   MotionBlur blur(source, shutter, prepared);      // prepared: the scene at the picture's time
//   for (unsigned i = 0; i < shutter.samples; ++i) {
//       const MotionBlur::Sample& sample = blur.at(i, view, progress);
//       frames.trace(sample.prepared, settings, *sample.view, i, ...);
//   }
//
// The structure of a sample is that of the picture's time, refitted; or, where that is not possible, built for the sample. So
// it depends on the picture and the number of the sample alone, and a picture looks the same in whatever order its samples and
// its frames are traced. One pose is held at a time, whatever the number of samples. Groups that a pose does not move are
// neither built nor uploaded again.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/motion/pose.hpp"
#include "scene/motion/pose_time.hpp"
#include "stand/multi_preparer.hpp"

namespace clarity {

class HostMover;
struct View;

// Used on one thread at a time.
class MotionBlur {
 public:
    // What moves.
    struct Source {
        std::shared_ptr<const Scene> rest;  // with its motion, and with what the user did to its instances
        std::string clip;                   // a name; empty: the first one
        FrameVertices read;                 // for sequences of files
        // Prepares a scene from the ground up, for poses in which the structure cannot be refitted.
        std::function<std::shared_ptr<const MultiPrepared>(std::shared_ptr<const Scene>, Progress&)> prepare;
    };
    // prepared: of the scene in its pose at shutter.time_s.
    MotionBlur(Source source, const Shutter& shutter, std::shared_ptr<const MultiPrepared> prepared);
    ~MotionBlur();

    struct Sample {
        std::shared_ptr<const MultiPrepared> prepared;
        std::shared_ptr<View> view;  // another one for each sample
        double time_s = 0;
    };
    // view: the picture's. Its camera and lights follow those of the scene that they are. The result is valid until the next
    // call. Throws as evaluate(), HostMover::move() and Source::prepare.
    const Sample& at(unsigned sample, const View& view, Progress& progress);

    const Shutter& shutter() const { return shutter_; }
    // Of all samples so far: how many were refitted, and how many built.
    unsigned refitted() const { return refitted_; }
    unsigned built() const { return built_; }

 private:
    Pose pose_at(double time_s) const;
    std::shared_ptr<const MultiPrepared> prepare(const Pose& pose, Progress& progress);
    std::shared_ptr<const MultiPrepared> refit(const Pose& pose, Progress& progress);
    View view_at(const View& view, const Pose& pose) const;

    const Source source_;
    const Shutter shutter_;
    const std::shared_ptr<const MultiPrepared> prepared_;
    std::optional<Pose> first_;  // of the picture's time
    Pose last_;                  // of sample_
    std::unique_ptr<HostMover> moving_;
    Sample sample_;
    unsigned refitted_ = 0, built_ = 0;
};

}  // namespace clarity
