// session.hpp -- the session: the state that the user desires, and the newest results of the threads.
//
// The window's parts change `desired` freely. Once a frame, update() compares it with the last requests and posts the
// differences: what must be rebuilt or recompiled goes to the preparing worker, the rest to the frame thread. Nothing here
// waits.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files/file_watch.hpp"
#include "base/log.hpp"
#include "device/kernel_watch.hpp"
#include "plugin/library_watch.hpp"
#include "ui/session/history.hpp"
#include "ui/session/log_buffer.hpp"
#include "ui/session/playback.hpp"
#include "ui/session/sequence.hpp"
#include "ui/session/view_options.hpp"
#include "ui/threads/desired_state.hpp"
#include "ui/threads/frame_thread.hpp"
#include "ui/threads/inspect_thread.hpp"
#include "ui/threads/prepare_worker.hpp"
#include "ui/threads/preview_thread.hpp"
#include "view/edit/preset.hpp"

namespace clarity::ui {

// The message over the picture.

// It stays until it is dismissed or its cause is gone.
struct WindowMessage {
    std::string text, details;
    Failure failure = Failure::other;
};

// Used on the window's thread.
class Messages {
 public:
    // Shows a failure, in place of the last one, and logs it.
    void report(const std::string& text, const std::string& details = {}, Failure failure = Failure::other) {
        log(LogLevel::error, details.empty() ? text : text + "\n" + details);
        shown_ = {text, details, failure};
        ++count_;
    }
    const WindowMessage& shown() const { return shown_; }  // without text: none
    void add(const std::string& text) { shown_.text += text; }
    void dismiss() { shown_ = {}; }
    uint64_t count() const { return count_; }  // of all that were reported

 private:
    WindowMessage shown_;
    uint64_t count_ = 0;
};

// The object selected in the picture or in the scene's tree.
struct Selection {
    rt_i32 instance = -1, prim = -1, material = -1;  // -1: none
    bool any() const { return instance >= 0 || prim >= 0 || material >= 0; }
};

// The session of one window. Used on the window's thread.
class Session {
 public:
    Session(const ViewOptions& options, std::function<void()> wake);

    DesiredState desired;
    unsigned selected_light = 0;
    Selection selection;
    bool editing_other = false;  // the rows of the panel edit desired.other

    const PluginRegistry& plugins() const { return plugins_; }
    LogBuffer& log_lines() { return log_; }
    std::shared_ptr<const std::vector<DeviceInfo>> devices() const { return worker_.devices(); }

    // Replaces the scene once the files are imported. Until then, and if the import fails, the old scene stays.
    void open(std::vector<std::string> files);
    // Cancels preparation and sets the desired state back to what is on the screen. A scene that plays is paused.
    void cancel();
    void reset_view();
    void adopt_view(const EditedView& edited);
    void set_accel(const std::string& id);  // of the edited side, with the default parameters
    // The settings that a row of the panel changes: those of the edited side, or of the main side if both sides share this
    // setting.
    Settings& settings_for(const std::string& key);
    Side& edited() { return editing_other && desired.other ? *desired.other : desired.main; }
    // Starts or ends the comparison. The second side begins as a copy of the first.
    void compare(bool on);
    void swap_sides();
    // Applies an edit in the words of edit.hpp. Throws Error(usage).
    void apply(const Word& word);
    // Whether the word names a picture that was not read with the scene. It is read then, and the edit made afterwards.
    bool waits_for_picture(const Word& word);

    void undo() { history_.undo(desired); }
    void redo() { history_.redo(desired); }
    const History& history() const { return history_; }

    // Throw Error; the desired state then stays as it was.
    void save_preset(const std::string& path) const;
    void load_preset(const std::string& path);
    // Returns the `clarity render ...` command which makes the main picture as desired, on its device.
    std::string render_command(const std::string& output) const;
    // Saves the current picture once its samples are traced: .png as shown, .exr or .pfm with the film's values. Success is a
    // line in the log, failure a message. Returns a number for cancel_save().
    uint64_t save_picture(const std::string& path);
    void cancel_save(uint64_t number) { frames_.cancel_save(number); }
    Sequence& sequence() { return sequence_; }
    Playback& playback() { return playback_; }
    const Playback& playback() const { return playback_; }

    // Traces the rays of a pixel of the newest picture for the inspector.
    void inspect(unsigned x, unsigned y);
    // Like inspect(), then selects the object that the camera ray hit.
    void pick(unsigned x, unsigned y);
    // Traces the samples of a pixel of the newest picture once more, to say why it is noisy.
    void explain(unsigned x, unsigned y);
    const InspectThread& inspector() const { return inspector_; }
    // Shows a ball of the material, of `size` pixels along a side. To be asked for in each frame in which it is to be seen.
    void want_preview(rt_u32 material, unsigned size);
    std::shared_ptr<const Preview> preview() const { return preview_.latest(); }  // nullptr: none yet
    // Says that this instance will be moved: it is kept apart in the structure, so that the first step is quick.
    void prepare_to_move(rt_u32 instance);
    // Where the middle of an instance is as desired: what it turns about. nullopt: there is no such instance.
    std::optional<std::array<float, 3>> middle_of(rt_u32 instance);

    // Called once a frame of the window. gesture: a slider is being dragged or a key is down.
    void update(bool gesture);

    std::shared_ptr<const Ready> ready() const { return ready_; }        // nullptr until something is prepared
    std::shared_ptr<const Picture> picture() const { return picture_; }  // the newest; nullptr until the first
    std::vector<std::string> files() const;                              // of the scene on the screen
    Activity activity() const { return worker_.activity(); }
    FrameTimes frame_times(unsigned side = 0) const { return frames_.times(side); }
    // Whether something moves or moved a moment ago, so that pictures may have fewer pixels.
    bool moving() const { return moving_; }
    // Watches the kernel files. A saved change is compiled and used at once.
    const KernelWatch& kernels() const { return *kernels_; }
    // Grows when a saved kernel or a rebuilt plugin is taken into force.
    uint64_t sources_revision() const { return sources_revision_; }
    // Whether the window needs the distances of pictures from now on.
    void want_distance(bool wanted) { frames_.want_distance(wanted); }
    // Whether nothing is being prepared or traced and the newest picture has arrived.
    bool idle() const;
    // Whether the desired state differs from what the picture was prepared with: work is under way, or it failed.
    bool behind() const;
    // Whether what was asked for last failed or was cancelled, so that it will not come by itself.
    bool not_in_force() const;

    Messages& messages() { return messages_; }
    const Messages& messages() const { return messages_; }

 private:
    void take_outcomes();
    void take_kernels();
    void take_libraries();
    void adopt(const std::shared_ptr<const Ready>& ready);
    void post_request();
    void post_frame();
    void note_sides(bool changed);
    bool edited_since_shown() const;
    void take_lost_devices();
    void watch_tracing();
    void note_lost_again();
    void follow_pose(const Ready& before);  // the file's lights, and its camera if the user looks through one
    void follow_path();
    void show_first_pose();
    EditedView first_view() const { return first_view_of(*ready_); }
    static EditedView first_view_of(const Ready& ready);  // of the scene in its pose, with the edits of its files
    void take_scene_files();
    void watch_scene_files();
    void reopen();
    std::vector<Word> edits_to_keep(const Ready& before) const;
    void follow_main();  // copies the shared settings of the main side to the other side
    void take_saved();
    void take_pick();
    void take_preview();
    PrepareRequest desired_request() const;
    void add_optics(PrepareRequest& request) const;
    bool is_posted(const PrepareRequest& request) const;
    Preset desired_preset(EditedView base) const;

    const PluginRegistry& plugins_;
    std::string first_camera_, first_light_;  // from the command line, for the first scene
    std::vector<Word> first_edits_;
    PoseTime first_pose_;
    const std::shared_ptr<const FloatImage> reference_;  // ViewOptions::reference
    SceneFiles asked_;                                   // of the scene that was asked for
    uint64_t last_files_revision_ = 0;
    std::optional<PrepareRequest> posted_request_;  // none: the next request is posted in any case
    uint64_t viewed_files_revision_ = 0;            // the scene that gave `desired` its camera and lights
    uint64_t reread_files_revision_ = 0;            // the same files read by a rebuilt importer: the camera stays
    uint64_t pictures_revision_ = 0;                // the same files, read again for pictures alone: undo stays, too
    std::vector<Word> waiting_edits_;               // for pictures that are being read
    std::shared_ptr<const Ready> ready_;
    std::shared_ptr<const Picture> picture_;
    FrameJob posted_job_;
    // What a picture is made of: its devices and settings as desired. `posted_sides_` are those of posted_job_, `shown_sides_`
    // those of the newest picture.
    struct Sides {
        Side main;
        std::optional<Side> other;
        uint64_t kernel_revision = 0;
    };
    Sides posted_sides_;
    std::optional<Sides> shown_sides_;
    std::weak_ptr<const Ready> lost_;                   // whose devices were lost last
    bool told_silent_ = false;                          // the user knows that tracing gives no sign of life
    std::shared_ptr<const Picture> picture_when_lost_;  // the newest then
    bool lost_again_ = false;                           // while they were opened anew; nothing was tried since
    bool keeps_message_ = false;                        // while what follows from it is prepared: it is not settled by that
    Messages messages_;
    History history_;
    Sequence sequence_;
    Playback playback_;
    std::optional<double> path_time_s_;  // for which the camera was set to its path
    std::vector<rt_u32> apart_;          // instances that the user is about to move
    MeshMiddles middles_;                // of the imported scene
    bool moving_ = false;
    double moved_at_s_ = -1e9;
    bool preview_wanted_ = false;  // since the last update
    uint64_t pick_request_ = 0, picked_request_ = 0;
    LogBuffer log_;
    const std::function<void()> wake_;
    std::unique_ptr<KernelWatch> kernels_;
    LibraryWatch libraries_;
    std::unique_ptr<FileWatch> scene_files_;  // of the scene on the screen, with all that it loads
    uint64_t seen_scene_files_ = 0;
    uint64_t seen_kernels_ = 0, sources_revision_ = 0;
    FrameThread frames_;
    InspectThread inspector_;
    PreviewThread preview_;
    PrepareWorker worker_;  // after the threads that it asks to release the devices
};

}  // namespace clarity::ui
