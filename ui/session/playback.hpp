// playback.hpp -- the clock of the timeline: which time of which clip the desired state asks for.
//
// The time advances as real time does, whatever it takes to build and trace a pose. Poses for which there is no time are never
// asked for.
#pragma once
#include <string>
#include <vector>

#include "ui/threads/desired_state.hpp"

namespace clarity::ui {

// Plays the clips of one scene. Paused times are those of whole frames. Used on the window's thread.
class Playback {
 public:
    // Takes the clips of a new scene, which is at rest at first.
    void open(const Scene& scene, DesiredState& desired);
    // Gives a scene without clips a stretch of time for a camera that moves: 10 s, and up to this time. Does nothing to others.
    void offer_stage(DesiredState& desired, double until_s);
    bool any() const { return !clips_.empty(); }
    const std::vector<ClipInfo>& clips() const { return clips_; }
    bool has(const std::string& clip) const;
    const ClipInfo& clip(const DesiredState& desired) const;  // the chosen one; any() must hold
    double fps(const DesiredState& desired) const { return frame_rate(clip(desired)); }

    bool playing() const { return playing_; }
    void play(DesiredState& desired);
    void pause(DesiredState& desired);  // at the nearest frame
    void toggle(DesiredState& desired) { playing_ ? pause(desired) : play(desired); }
    // The clock stands still while the user holds the time with the mouse.
    void hold(bool held) { held_ = held; }

    // Shows the frame nearest to a time.
    void show(DesiredState& desired, double time_s);
    // Shows another frame, `frames` later; from one end of the loop on to the other. Pauses.
    void step(DesiredState& desired, int frames);
    void rest(DesiredState& desired);                                  // back to the scene at rest; pauses
    void choose(DesiredState& desired, const std::string& clip);       // shows its begin
    void set_loop(DesiredState& desired, double from_s, double to_s);  // within the clip, at least one frame

    // Sets a key of the camera's path at the time that is shown, or takes it away. A scene without clips gets a timeline.
    void set_camera_key(DesiredState& desired);
    static void remove_camera_key(DesiredState& desired);

    // Called once a frame of the window, with the time of a steady clock.
    void advance(DesiredState& desired, double now_s);

 private:
    std::vector<ClipInfo> clips_;
    bool playing_ = false, held_ = false;
    bool has_stage_ = false;  // the only clip is none of the scene
    double last_s_ = 0;       // of the steady clock
};

}  // namespace clarity::ui
