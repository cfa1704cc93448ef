// app.hpp -- the running window. Each turn of its loop handles events, updates the session's desired state, and draws the
// newest picture.
#pragma once
#include <atomic>
#include <memory>

#include "ui/app/gl_window.hpp"
#include "ui/app/preferences.hpp"
#include "ui/app/preferences_sync.hpp"
#include "ui/automation/scripted_window.hpp"
#include "ui/overlay/overlay.hpp"
#include "ui/session/session.hpp"
#include "ui/viewport/picture_pane.hpp"
#include "ui/viewport/picture_texture.hpp"
#include "ui/widgets/ui_state.hpp"

namespace clarity::ui {

class Script;

// The window and everything in it. All members are called on the main thread, which owns the GL context.
class App {
 public:
    explicit App(const ViewOptions& options);
    ~App();
    // Runs the window's loop until the window is closed. Returns the program's exit code.
    int run();

 private:
    void turn();
    bool due() const;  // whether a frame is to be drawn now
    double wait_seconds() const;
    double longest_wait() const;  // seconds until the next turn if nothing happens
    void give_memory_back();
    bool typing() const;
    void run_script();
    void take_keys();
    KeyTarget key_target() { return {*session_, state_, *overlay_}; }
    void act(const KeyBinding& binding);
    void press(const KeyBinding& binding);
    void move_held(float seconds);
    void apply_motion(float seconds, const HeldKeys& keys);
    void draw();
    void upload_picture();
    void upload_preview();
    void finish_frame();

    std::atomic<bool> woken_{false};  // set by threads which have news, cleared by turn()
    std::string folder_;              // of the preferences; empty: there is none
    std::unique_ptr<GlWindow> window_;
    std::unique_ptr<PicturePane> pane_;
    std::unique_ptr<Session> session_;
    std::unique_ptr<VolumeOverlay> overlay_;
    std::unique_ptr<Script> script_;
    UiState state_;
    UiTimes times_;
    PreferencesSync preferences_sync_;
    HeldKeys held_;
    std::shared_ptr<const Picture> uploaded_;
    std::unique_ptr<PictureTexture> preview_;
    std::shared_ptr<const Preview> uploaded_preview_;
    std::string capture_path_;
    double last_turn_s_ = 0;   // start of the last turn, in seconds of the steady clock
    double trimmed_s_ = 0;     // when memory was last given back
    bool worked_ = false;      // since then
    double oldest_key_s_ = 0;  // time of the oldest key event that the coming frame handles; 0: no key event
    int settle_frames_ = 3;    // frames still to draw: ImGui needs a few to settle after an event
};

}  // namespace clarity::ui
