// pose_time.hpp -- at which time of which clip a scene is shown, the frames of a clip, and the times
// of samples while a shutter is open.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "scene/motion/pose.hpp"

namespace clarity {

struct PoseTime {
    std::optional<double> time_s;  // on the clip's own clock; empty: the scene is at rest
    std::string clip;              // name; empty: the first one
};
// Whether both show the same pose of a scene.
bool same_pose(const PoseTime& a, const PoseTime& b);

// The clip that a user names: by its name, or else by its number, counted from 0 in the order of clips(). Empty: the first one,
// or ClipInfo() if there is none. Throws Error(usage), which lists the clips, if the scene has no such clip.
ClipInfo find_clip(const Scene& scene, const std::string& text);

// The clips that a timeline can play. A scene without clips, but with vertices that a file keeps for several times, has one
// without a name. Empty: there is nothing to play.
std::vector<ClipInfo> playable_clips(const Scene& scene);

// Frames a second: as asked, if that is not 0, else those of the clip, else 24.
double frame_rate(const ClipInfo& clip, double asked = 0);
// Frame n is at n / fps on the clip's clock, for whoever asks and in any order.
inline double time_of_frame(double number, double fps) {
    return number / fps;
}
// The numbers of the frames within a clip; at least one.
struct FrameSpan {
    long first = 0, last = 0;
};
FrameSpan frames_of(const ClipInfo& clip);
// The frame nearest to a time.
long frame_at(double time_s, double fps);

// The times of a picture's samples while a shutter is open.

// A shutter that is open around the time of a picture: half of it before, half after.
struct Shutter {
    double time_s = 0;     // of the picture, on the clip's clock
    double open_s = 0;     // how long it is open; 0: all samples are at the picture's time
    unsigned samples = 1;  // of a pixel
    bool operator==(const Shutter& b) const { return time_s == b.time_s && open_s == b.open_s && samples == b.samples; }
};

// The time of a sample. The shutter's time is cut into as many equal parts as there are samples, and each sample is in the
// middle of one. Samples that follow each other are in parts far apart, so that a picture of some of its samples is evenly
// blurred, too. Depends on the arguments alone.
double sample_time(const Shutter& shutter, unsigned sample);

}  // namespace clarity
