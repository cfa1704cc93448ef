// session.hpp -- what the window works on: the state a user wishes for, and the newest that the threads made of it.
//
// The window's parts change `wish` as they like; update(), once a frame, compares it with what was asked for last and posts the
// difference: to the preparing worker what must be rebuilt or recompiled, to the frame thread the rest. Nothing here waits.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "device/kernel_watch.hpp"
#include "render/settings/preset.hpp"
#include "ui/app/window_main.hpp"
#include "ui/session/desired_state.hpp"
#include "ui/session/frame_thread.hpp"
#include "ui/session/history.hpp"
#include "ui/session/inspect_thread.hpp"
#include "ui/session/log_buffer.hpp"
#include "ui/session/prepare_worker.hpp"
#include "ui/session/sequence.hpp"

namespace clarity::ui {

// What stands over the picture until it is dismissed or mended.
struct WindowMessage {
    std::string text, details;
};

// What was picked in the picture or in the scene's tree.
struct Selection {
    rt_i32 instance = -1, prim = -1, material = -1;  // -1: none
    bool any() const { return instance >= 0 || prim >= 0 || material >= 0; }
};

class Session {
 public:
    Session(const ViewOptions& options, std::function<void()> wake);

    DesiredState desired;
    unsigned selected_light = 0;
    Selection selection;
    bool editing_other = false;  // the panel's rows are of wish.other

    const PluginRegistry& plugins() const { return plugins_; }
    LogBuffer& log_lines() { return log_; }
    std::shared_ptr<const std::vector<DeviceInfo>> devices() const { return worker_.devices(); }

    // Replaces the scene once the files are imported; until then, and if that fails, the old one stays.
    void open(std::vector<std::string> files);
    // Drops what is being prepared and wishes for what is on the screen again.
    void cancel();
    void reset_view();
    void adopt_view(const EditedView& edited);
    void set_accel(const std::string& id);  // with its parameters' defaults, of the side that is edited
    // The settings that a row changes: of the edited side, but what both share is the main one's.
    Settings& settings_for(const std::string& key);
    Side& edited() { return editing_other && desired.other ? *desired.other : desired.main; }
    // Starts or ends the comparison; the second side begins as a copy of the first.
    void compare(bool on);
    void swap_sides();

    void undo() { history_.undo(desired); }
    void redo() { history_.redo(desired); }
    const History& history() const { return history_; }

    // Throw Error; what was wished stays as it was.
    void save_preset(const std::string& path) const;
    void load_preset(const std::string& path);
    // `clarity render ...` that makes the main picture as it is wished, on the device that it has.
    std::string render_command(const std::string& output) const;
    // The picture as it is now, when its samples are in: .png as shown, .exr or .pfm with the film's values. The outcome is a
    // line in the log, or a message. Returns a number for cancel_save().
    uint64_t save_picture(const std::string& path);
    void cancel_save(uint64_t number) { frames_.cancel_save(number); }
    Sequence& sequence() { return sequence_; }

    // Follows the rays of a pixel of the newest picture.
    void inspect(unsigned x, unsigned y);
    // The same, and then selects what its camera ray met.
    void pick(unsigned x, unsigned y);
    std::shared_ptr<const Inspection> inspection() const { return inspector_.latest(); }
    bool inspecting() const { return inspector_.busy(); }
    // Moves the camera's target, and the eye with `nearer` < 1 towards it.
    void focus_on(const std::array<float, 3>& point, float nearer = 1);
    void focus_on_instance(rt_u32 instance);
    void frame_selection();  // or all of the scene
    float picture_aspect() const;
    // The materials to edit: the wish's own, copied from the scene at the first edit.
    rt_material& edited_material(rt_u32 index);
    const rt_material& material(rt_u32 index) const;
    bool hidden(rt_u32 instance) const;
    void hide(rt_u32 instance, bool hidden);

    // Once a frame of the window. gesture: a slider is being dragged, a key is down.
    void update(bool gesture);

    std::shared_ptr<const Ready> ready() const { return ready_; }        // nullptr until something is prepared
    std::shared_ptr<const Picture> picture() const { return picture_; }  // newest; nullptr at first
    std::vector<std::string> files() const;                              // of the scene on the screen
    Activity activity() const { return worker_.activity(); }
    std::vector<float> frame_times(unsigned side = 0) const { return frames_.times(side); }
    // The camera or a light moved a moment ago: pictures may be coarse.
    bool moving() const { return moving_; }
    // Whose files are watched; a saved change is compiled and swapped in by itself.
    const KernelWatch& kernels() const { return kernels_; }
    // The window needs the distances of pictures, or no longer does.
    void want_distance(bool wanted) { frames_.want_distance(wanted); }
    // Nothing is being prepared or traced, and the newest picture is here.
    bool idle() const;
    // Whether the wish differs from what the picture was prepared with: something is under way, or failed.
    bool behind() const;
    double frames_per_second(unsigned side = 0) const;
    double mrays_per_second(unsigned side = 0) const;
    std::string frame_rate_line() const;
    // Length that steps are measured by: the scene's diagonal.
    float scene_size() const;

    const WindowMessage& message() const { return message_; }
    void dismiss_message() { message_ = {}; }
    void report(const std::string& text, const std::string& details = {});  // a failure: message and log
    uint64_t message_count() const { return message_count_; }

 private:
    void take_outcomes();
    void adopt(const std::shared_ptr<const Ready>& ready);
    void post_request();
    void post_frame();
    void follow_main();  // what of the other side is always the main one's
    void take_saved();
    void take_pick();
    PrepareRequest desired_request() const;
    Preset desired_preset(const View& base) const;

    const PluginRegistry& plugins_;
    std::string first_camera_, first_light_;  // from the command line, for the first scene
    std::vector<Word> first_edits_;
    std::vector<std::string> files_;  // asked for
    uint64_t files_revision_ = 0, last_files_revision_ = 0;
    std::string posted_key_;
    std::string ready_key_;
    uint64_t viewed_files_revision_ = 0;  // whose camera and lights are in the wish
    std::shared_ptr<const Ready> ready_;
    std::shared_ptr<const Picture> picture_;
    FrameJob posted_job_;
    WindowMessage message_;
    uint64_t message_count_ = 0;
    History history_;
    Sequence sequence_;
    bool moving_ = false;
    double moved_at_s_ = -1e9;
    uint64_t pick_request_ = 0, picked_request_ = 0;
    LogBuffer log_;
    KernelWatch kernels_;
    uint64_t seen_kernels_ = 0;
    FrameThread frames_;
    InspectThread inspector_;
    PrepareWorker worker_;  // after those that it asks to let go
};

}  // namespace clarity::ui
