// timeline.hpp -- the timeline under the picture: play and pause, frames, the loop, speed and clips.
//
//   the bar at the top        the loop: its two ends can be dragged; double click: the whole clip
//   the track below it        a press or a drag shows the frame there
#pragma once
#include "ui/session/session.hpp"
#include "ui/widgets/rect.hpp"

namespace clarity::ui {

// The height that it needs at a width; 0 if the scene has no clips.
float timeline_height(const Session& session, float width);
void draw_timeline(const Rect& area, Session& session);

}  // namespace clarity::ui
