#include "ui/app/app.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <thread>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/files/process_folder.hpp"
#include "base/log.hpp"
#include "base/machine.hpp"
#include "base/pictures/image_io.hpp"
#include "ui/app/key_actions.hpp"
#include "ui/automation/script.hpp"
#include "ui/browser/file_browser.hpp"
#include "ui/hud/hud.hpp"
#include "ui/panel/panel.hpp"
#include "ui/session/camera_control.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/theme.hpp"

namespace clarity::ui {
namespace {

// Ends the program if its threads do not. No call of OpenCL stops a launch on a CPU, or returns from a call
// that hangs in a driver, so a window that waited for its threads would stay as a process without a window.

// If this object lives longer than the limit and no picture is being written, the process ends with exit code 0, after a line
// on stderr. Nothing is lost: the caller has saved what is to be kept, and the kernel ends our workers with us.
class CloseLimit {
 public:
    explicit CloseLimit(double seconds) : thread_([this, seconds] { run(seconds); }) {}
    ~CloseLimit() {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            closed_ = true;
        }
        changed_.notify_all();
        thread_.join();
    }
    CloseLimit(const CloseLimit&) = delete;
    CloseLimit& operator=(const CloseLimit&) = delete;

 private:
    void run(double seconds) {
        std::unique_lock<std::mutex> lock(mutex_);
        const auto closed = [this] { return closed_; };
        do
            if (changed_.wait_for(lock, std::chrono::duration<double>(seconds), closed)) return;
        while (PendingWrite::any());
        log(LogLevel::warning, "the OpenCL driver did not stop within " + std::to_string(static_cast<int>(seconds)) +
                                   " s after the window was closed, so the program was ended");
        std::fflush(nullptr);
        leave_process_folders();
        _exit(0);
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    bool closed_ = false;
    std::thread thread_;  // last member: the thread starts when all others exist
};

// SIGTERM, SIGHUP and Ctrl-C close the window as its button does, so that preferences are saved and temporary files removed. A
// second signal ends the program at once.
volatile std::sig_atomic_t asked_to_end = 0;

class EndOnSignal {
 public:
    EndOnSignal() {
        struct sigaction action{};
        action.sa_handler = [](int) { asked_to_end = 1; };
        action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
        for (const int signal : {SIGTERM, SIGHUP, SIGINT}) {
            // A shell starts background jobs with SIGINT ignored; do not change that.
            struct sigaction old{};
            if (sigaction(signal, nullptr, &old) == 0 && old.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
        }
    }
};

constexpr float kTapSeconds = 0.06f;  // a key press moves by at least this much time's motion, however short it was
constexpr float kLongestStep =
    0.1f;  // longest time that one step of motion covers, so that nothing jumps after the loop paused
constexpr float kTurnRadPerSecond = 0.9f;
constexpr double kShortestTurn = 0.01;
constexpr double kWhileBusy_s = 0.1;  // between frames that show a bar of progress: the work needs the processors
constexpr double kCloseSeconds = 5;   // the threads may take this long to end when the window is closed

}  // namespace

App::App(const ViewOptions& options) {
    folder_ = preferences_folder();
    std::string damage;
    const Preferences preferences = load_preferences(folder_, &damage);
    const std::string ini = folder_.empty() ? std::string() : folder_ + "/imgui.ini";
    window_ = std::make_unique<GlWindow>("Clarity", preferences.width, preferences.height, ini);
    state_.text_scale = preferences.text_scale;
    state_.camera_speed = preferences.camera_speed;
    state_.light_speed = preferences.light_speed;
    state_.panel_visible = preferences.panel_visible;
    const std::string& id = options.key_map.empty() ? preferences.key_map : options.key_map;
    if (const KeyMap* map = find_key_map(id)) state_.key_map = map;
    pane_ = std::make_unique<PicturePane>();
    const auto wake = [this] {
        woken_ = true;
        GlWindow::wake();
    };
    session_ = std::make_unique<Session>(options, wake);
    if (!damage.empty()) session_->messages().report(damage);
    preferences_sync_.begin(folder_, preferences, state_, session_->desired);
    overlay_ = std::make_unique<VolumeOverlay>(wake);
    script_ = Script::from_environment();
    apply_theme(static_cast<float>(window_->content_scale()) * state_.text_scale);
}

App::~App() {
    stop_file_browser();
    Preferences preferences;
    window_->size(preferences.width, preferences.height);
    preferences.text_scale = state_.text_scale;
    preferences.camera_speed = state_.camera_speed;
    preferences.light_speed = state_.light_speed;
    preferences.key_map = state_.key_map->id;
    preferences.panel_visible = state_.panel_visible;
    preferences_sync_.note(preferences, state_, session_->desired);
    save_preferences(folder_, preferences);
    // The session waits for its threads, which may be in the middle of a launch. So the window closes first.
    window_->hide();
    window_->wait_events(0);
    const CloseLimit limit(kCloseSeconds);
    overlay_.reset();
    session_.reset();
    pane_.reset();
    preview_.reset();
}

int App::run() {
    const EndOnSignal signals;
    turn();
    while (!window_->closing() && !asked_to_end) {
        if (window_->wait_events(wait_seconds())) settle_frames_ = 3;
        if (!due()) continue;
        turn();
        give_memory_back();
    }
    return static_cast<int>(asked_to_end ? Exit::interrupted : Exit::done);
}

// Whether a frame is due: after an event, news from a thread, a key that is down, a line of the script, or when the clock asks
// for one. At most 100 frames a second are drawn (kShortestTurn), even if a small picture is traced 1000 times a second.
bool App::due() const {
    const double since = now_s() - last_turn_s_;
    if (settle_frames_ > 0 || (script_ && script_->has_lines() && (!script_->waits_for_work() || since >= kWhileBusy_s)))
        return true;
    if (woken_ || held_.any_held(*state_.key_map)) return since >= kShortestTurn;
    return since >= longest_wait();
}

// When nothing is to do. Scenes, structures and compilers leave holes in the heaps of their threads: a window that got 14,500
// random actions in half an hour grew by 1.3 MiB a minute, though all that it still used at the end was what it had used in the
// beginning.
void App::give_memory_back() {
    constexpr double kEvery_s = 10;  // what comes next must fetch its pages again
    const bool idle = session_->idle();
    worked_ |= !idle;
    if (!idle || !worked_ || now_s() - trimmed_s_ < kEvery_s) return;
    give_free_memory_back();
    trimmed_s_ = now_s();
    worked_ = false;
}

double App::longest_wait() const {
    if (session_->playback().playing()) return 1.0 / 60;
    if (!overlay_->ready() || session_->moving()) return 1.0 / 30;
    if (session_->activity().busy) return kWhileBusy_s;
    return typing() ? 0.1 : 0.5;  // the cursor of a text field blinks
}

double App::wait_seconds() const {
    if (settle_frames_ > 0) return 0;
    if (woken_ || held_.any_held(*state_.key_map)) return std::max(kShortestTurn - (now_s() - last_turn_s_), 1e-4);
    const double wait = std::max(longest_wait() - (now_s() - last_turn_s_), 1e-4);
    return script_ ? std::min(wait, 0.005) : wait;  // no event tells us that the script has a new line: poll for it every 5 ms
}

bool App::typing() const {
    return ImGui::GetIO().WantTextInput || state_.browser_open;  // keys never move the camera behind the file browser
}

void App::turn() {
    const double begin = now_s();
    woken_ = false;
    const auto seconds = static_cast<float>(std::min(begin - last_turn_s_, static_cast<double>(kLongestStep)));
    last_turn_s_ = begin;
    take_keys();
    if (auto files = window_->take_dropped_files(); !files.empty()) session_->open(std::move(files));
    if (script_) run_script();
    move_held(seconds);
    try {
        session_->update(ImGui::IsAnyItemActive() || held_.any_held(*state_.key_map));
    } catch (const Error& error) {
        session_->messages().report(error.what(), error.details());
    }
    preferences_sync_.follow(*session_, state_);
    const auto ready = session_->ready();
    const auto structure = [](const ReadySide& side) { return ShownStructure{side.accel, side.moved, side.is_moved}; };
    overlay_->update(ready ? structure(ready->main) : ShownStructure(),
                     ready && ready->other ? structure(*ready->other) : ShownStructure());
    apply_theme(static_cast<float>(window_->content_scale()) * state_.text_scale);
    upload_picture();
    window_->begin_frame();
    draw();
    finish_frame();
    if (settle_frames_ > 0) --settle_frames_;
    const double end = now_s();
    ++times_.frames;
    times_.slowest_frame_ms = std::max(times_.slowest_frame_ms, (end - begin) * 1e3);
    if (oldest_key_s_ > 0) times_.slowest_answer_ms = std::max(times_.slowest_answer_ms, (end - oldest_key_s_) * 1e3);
    oldest_key_s_ = 0;
}

void App::run_script() {
    ScriptedWindow window{*session_,
                          state_,
                          *overlay_,
                          *pane_,
                          times_,
                          [this](const std::vector<std::string>& files) { window_->drop(files); },
                          [this](const std::string& path) { capture_path_ = path; },
                          [this] { window_->close(); },
                          [this](float seconds) { window_->set_double_click_s(seconds); }};
    script_->step(window);
}

void App::finish_frame() {
    if (capture_path_.empty()) {
        window_->end_frame();
        return;
    }
    const ByteImage image = window_->end_frame_and_read();
    try {
        write_image(capture_path_, {}, image);
    } catch (const Error& error) {
        session_->messages().report(error.what());
    }
    capture_path_.clear();
}

void App::take_keys() {
    for (const KeyEvent& event : window_->take_keys()) {
        if (oldest_key_s_ == 0) oldest_key_s_ = now_s() - event.age_s();
        if (event.kind == KeyEvent::Kind::lost_focus) {
            held_.clear();
        } else if (event.kind == KeyEvent::Kind::release) {
            held_.release(event.key);
        } else if (event.key == GLFW_KEY_ESCAPE && (state_.browser_open || state_.keys_open)) {
            KeyTarget target = key_target();
            close_or_cancel(target);  // even while a text field has the keyboard
        } else if (!event.other_modifier && !typing()) {
            if (const KeyBinding* binding = state_.key_map->find(event.key, event.ctrl)) act(*binding);
        }
    }
}

// Runs the key's action. If it fails, the failure is shown as a message.
void App::act(const KeyBinding& binding) {
    try {
        press(binding);
    } catch (const Error& error) {
        session_->messages().report(error.what(), error.details());
    }
}

void App::press(const KeyBinding& binding) {
    if (binding.press) {
        KeyTarget target = key_target();
        binding.press(target);
        return;
    }
    held_.press(binding.key);
    HeldKeys tapped;
    tapped.press(binding.key);
    apply_motion(kTapSeconds, tapped);
}

void App::move_held(float seconds) {
    apply_motion(seconds, held_);
}

void App::apply_motion(float seconds, const HeldKeys& keys) {
    if (!keys.any_held(*state_.key_map)) return;
    const auto between = [&](Motion less, Motion more) {
        return keys.value(*state_.key_map, more) - keys.value(*state_.key_map, less);
    };
    const float step = scene_size(*session_) * 0.33f * seconds;
    const float camera = step * state_.camera_speed, turn = kTurnRadPerSecond * seconds * std::min(state_.camera_speed, 2.0f);
    const Step walk{between(Motion::camera_left, Motion::camera_right) * camera,
                    between(Motion::camera_down, Motion::camera_up) * camera,
                    between(Motion::camera_back, Motion::camera_forward) * camera};
    Camera& eye = session_->desired.camera;
    if (!walk.none()) state_.key_map->mouse_look ? fly_camera(eye, walk) : move_camera(eye, walk);
    const float yaw = between(Motion::yaw_right, Motion::yaw_left) * turn,
                pitch = between(Motion::pitch_down, Motion::pitch_up) * turn;
    if (yaw != 0 || pitch != 0) turn_camera(eye, yaw, pitch);

    const float reach = step * state_.light_speed;
    const Step shift{between(Motion::light_left, Motion::light_right) * reach,
                     between(Motion::light_down, Motion::light_up) * reach,
                     between(Motion::light_back, Motion::light_forward) * reach};
    auto& lights = session_->desired.lights;
    if (!shift.none() && session_->selected_light < lights.size())
        move_light(lights[session_->selected_light].values, eye, shift, scene_size(*session_));
}

}  // namespace clarity::ui
