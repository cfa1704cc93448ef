// timeline.hpp -- the timeline under the picture: play and pause, frames, the loop, speed and clips.
//
//   the bar at the top        the loop: its two ends can be dragged; double click: the whole clip
//   the track below it        a press or a drag shows the frame there
#pragma once
#include <vector>

#include "ui/session/session.hpp"
#include "ui/widgets/rect.hpp"

namespace clarity::ui {

// The height that it needs at a width; 0 if the scene has no clips.
float timeline_height(const Session& session, float width);
void draw_timeline(const Rect& area, Session& session);

// Where times lie on the timeline, and which frames are marked. Pure arithmetic.

// Times from begin_s to end_s lie evenly from left to right.
struct TimelineScale {
    double begin_s = 0, end_s = 1;
    float left = 0, right = 1;  // of the window, in its units
    float place_of(double time_s) const;
    double time_at(float place) const;  // begin_s or end_s outside
};

// The distance of marked frames, 1, 2, 5, 10, 20, ..., so that marks are at least `least` apart. fps: frames a second.
long mark_step(const TimelineScale& scale, double fps, float least);
// The numbers of the marked frames, multiples of `step`.
std::vector<long> marked_frames(const TimelineScale& scale, double fps, long step);

}  // namespace clarity::ui
