#include "ui/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "plugin/parameters.hpp"
#include "ui/session/comparisons.hpp"
#include "view/settings/accel_choice.hpp"
#include "view/settings/aov.hpp"
#include "view/view.hpp"

namespace clarity::ui {
namespace {

// Whether both jobs trace the same frames of the same sides.
bool same_frames(const FrameJob& a, const FrameJob& b) {
    return traces_same(a.settings, b.settings) && a.other_settings.has_value() == b.other_settings.has_value() &&
           (!a.other_settings || traces_same(*a.other_settings, *b.other_settings));
}

// Of what may be denoised, so that this begins without a wait.
void ask_for_guides(Settings& settings) {
    if (settings.denoise != "off" && find_setting("denoise")->used(settings)) settings.optics.guides = 1;
}

constexpr double kMovingSeconds = 0.25;  // pictures are sharp again this long after the last change of the view

}  // namespace

Session::Session(const ViewOptions& options, std::function<void()> wake)
    : plugins_(*options.plugins),
      first_camera_(options.camera),
      first_light_(options.light),
      first_edits_(options.edits),
      first_pose_(options.pose),
      reference_(options.reference),
      log_(wake),
      wake_(wake),
      kernels_(std::make_unique<KernelWatch>(plugins_.with_kernels(), wake)),
      libraries_(plugins_, wake),
      frames_(wake),
      inspector_(wake),
      preview_(plugins_, wake),
      worker_(plugins_, options.import,
              {[this] {
                   frames_.release();
                   inspector_.release();
                   preview_.release();
               },
               [this] {
                   frames_.resume();
                   inspector_.resume();
                   preview_.resume();
               }},
              wake) {
    desired.main = {options.device, options.settings};
    if (desired.main.settings.accel.empty())
        choose_accel(plugins_, default_accel(plugins_, options.device), desired.main.settings);
    if (desired.main.settings.accel_params.empty())
        if (const rt_plugin* accel = plugins_.accel(desired.main.settings.accel))
            desired.main.settings.accel_params = default_parameters(*accel);
    if (!options.scenes.empty()) open(options.scenes);
    asked_.pictures = pictures_of(first_edits_);
}

void Session::open(std::vector<std::string> files) {
    asked_.files = std::move(files);
    asked_.files_revision = ++last_files_revision_;
    asked_.pictures.clear();
    waiting_edits_.clear();
}

void Session::set_accel(const std::string& id) {
    const rt_plugin* plugin = plugins_.accel(id);
    if (!plugin) throw Error(Exit::usage, "no acceleration structure `" + id + "` among the plugins");
    edited().settings.accel = id;
    edited().settings.accel_params = default_parameters(*plugin);
}

void Session::compare(bool on) {
    editing_other = false;
    if (on && !desired.other) desired.other = desired.main;
    if (!on) desired.other.reset();
}

void Session::swap_sides() {
    if (desired.other) std::swap(desired.main, *desired.other);
}

std::vector<std::string> Session::files() const {
    return ready_ ? ready_->loaded->files : std::vector<std::string>();
}

void Session::cancel() {
    // Of a scene that plays only the next pose is being prepared.
    if (playback_.playing() && ready_ && prepares_same_but_pose(ready_->request, desired_request()))
        return playback_.pause(desired);
    worker_.cancel();
    if (!ready_) return;
    const PrepareRequest& was = ready_->request;
    const bool was_withdrawn = ready_->withdrawn();
    // Settings that only concern frames keep their desired values.
    const auto back = [](Side& side, const Side& to) {
        side.device = to.device;
        side.settings = frame_settings(to.settings, side.settings);
    };
    back(desired.main, was.main);
    if (was.other && desired.other)
        back(*desired.other, *was.other);
    else
        desired.other = was.other;
    static_cast<ObjectEdits&>(desired) = was;
    apart_ = was.apart;
    playback_.rest(desired);
    if (was.pose.time_s) {
        if (was.pose.clip != desired.pose.clip) playback_.choose(desired, was.pose.clip);
        desired.pose = was.pose;
    }
    asked_ = was;
    waiting_edits_.clear();
    // The prepared scene already has these settings, so there is nothing to request, unless its devices were closed meanwhile.
    posted_request_.reset();
    if (was_withdrawn) return;
    posted_request_ = desired_request();
    // The view has been edited all the same, so kernels that know it are asked for again.
    posted_request_->main.settings.optics = was.main.settings.optics;
    if (was.other && posted_request_->other) posted_request_->other->settings.optics = was.other->settings.optics;
}

Settings& Session::settings_for(const std::string& key) {
    const Setting* const row = find_setting(key);
    return row && row->shared() ? desired.main.settings : edited().settings;
}

void Session::follow_main() {
    if (!desired.other) {
        editing_other = false;
        return;
    }
    Settings& other = desired.other->settings;
    for (const Setting& row : settings_table())
        if (row.shared()) row.copy(other, desired.main.settings);
}

PrepareRequest Session::desired_request() const {
    PrepareRequest request;
    static_cast<SceneFiles&>(request) = asked_;
    request.camera = first_camera_;
    request.light = first_light_;
    request.main = desired.main;
    request.other = desired.other;
    request.kernel_revision = sources_revision_;
    ask_for_guides(request.main.settings);
    if (request.other) ask_for_guides(request.other->settings);
    // Indices of instances and names of clips are only valid in the scene that they were chosen in.
    if (asked_.files_revision == viewed_files_revision_) {
        static_cast<ObjectEdits&>(request) = desired;
        request.apart = apart_;
        if (desired.pose.time_s) request.pose = desired.pose;
        add_optics(request);
    }
    return request;
}

// Edits may bring lights and surfaces that the kernels do not know. Kernels that know more than is shown are kept.
void Session::add_optics(PrepareRequest& request) const {
    if (!ready_) return;
    const View view = edited_view(desired).view;
    const auto add = [&](Settings& settings, const Settings& prepared) {
        settings.optics = settings.optics | prepared.optics;
        if (!knows(settings, *ready_->loaded->scene, view))
            settings.optics = settings.optics | optics_of(*ready_->loaded->scene, view, settings);
    };
    add(request.main.settings, ready_->request.main.settings);
    if (request.other)
        add(request.other->settings, (ready_->request.other ? *ready_->request.other : ready_->request.main).settings);
}

bool Session::is_posted(const PrepareRequest& request) const {
    return posted_request_ && prepares_same(*posted_request_, request);
}

void Session::post_request() {
    PrepareRequest request = desired_request();
    if (is_posted(request)) return;
    // One pose is made at a time, when the one before it is being traced: the next is then of the newest time, and no pose is
    // made which nobody sees.
    request.only_pose = posted_request_ && prepares_same_but_pose(*posted_request_, request);
    if (request.only_pose && (worker_.activity().busy || !frames_.begun())) return;
    posted_request_ = request;
    for (unsigned side = 0; side < 2; ++side) {
        const std::vector<float> times = frame_times(side).frames_ms();
        if (!times.empty()) request.frame_ms[side] = static_cast<double>(times.back());
    }
    worker_.request(std::move(request));
}

void Session::post_frame() {
    if (!ready_) return;
    FrameJob job = posted_job_;
    job.ready = ready_;
    job.settings = desired.main.settings;
    // For every AOV but colours, a new sample replaces the last one. Sixteen samples would only make the picture tremble.
    if (!find_aov(ready_->main.settings.aov).adds_samples()) job.settings.spp = 1;
    job.other_settings.reset();
    if (desired.other) job.other_settings = desired.other->settings;
    EditedView edited = edited_view(desired);
    job.view = visible_view(edited);
    job.known = ready_->knows(job.view);
    job.camera_path = edited.follows_path ? std::move(edited.camera_path) : CameraPath();
    job.reference = reference_;
    job.continuous = desired.continuous;
    // Samples that are spread in time have their number beforehand.
    job.equal_time = desired.other && desired.equal_time && find_aov(ready_->main.settings.aov).adds_samples();
    job.part = desired.part;
    job.resolution_scale = std::clamp(desired.resolution_scale, 0.05f, 4.0f);
    const bool first = !posted_job_.ready;
    const bool moved = !first && (!same_view(job.view, posted_job_.view) ||
                                  !same_pose(job.ready->request.pose, posted_job_.ready->request.pose) ||
                                  !same_edits(job.ready->request, posted_job_.ready->request));
    const double now = now_s();
    if (moved) moved_at_s_ = now;
    moving_ = (now - moved_at_s_ < kMovingSeconds || playback_.playing()) && !sequence_.running();
    job.moving = moving_;
    job.moving_fps = moving_ ? desired.moving_fps : 0;
    // Pictures that are gone at once are not blurred.
    const bool blurred = blurs(job.settings) && job.ready->request.pose.time_s && playback_.any() && !moving_;
    job.open_s = blurred ? job.settings.shutter / playback_.fps(desired) : 0;
    const bool other_times =
        job.open_s != posted_job_.open_s ||
        (blurred && (job.settings.spp != posted_job_.settings.spp || !(job.camera_path == posted_job_.camera_path)));
    job.equal_time &= job.open_s <= 0;
    const bool anew = first || moved || other_times || job.equal_time != posted_job_.equal_time ||
                      job.ready != posted_job_.ready || !same_frames(job, posted_job_) ||
                      job.settings.spp < posted_job_.settings.spp || job.resolution_scale != posted_job_.resolution_scale ||
                      job.part != posted_job_.part;
    const bool filtered = job.settings.denoise == "moving" && job.moving != posted_job_.moving;
    const bool shown = first || filtered || !displays_same(job.settings, posted_job_.settings);
    const bool other = job.settings.spp != posted_job_.settings.spp || job.continuous != posted_job_.continuous ||
                       job.moving_fps != posted_job_.moving_fps;
    if (anew || shown || other) {
        job.revision += anew;
        job.display_revision += shown;
        posted_job_ = job;
        note_sides(anew);
        frames_.post(std::move(job));
    }
}

void Session::update(bool gesture) {
    take_outcomes();
    take_kernels();
    take_libraries();
    take_scene_files();
    if (auto why = frames_.take_failure(); !why.empty()) messages_.report(why);
    take_lost_devices();
    watch_tracing();
    sequence_.update(*this);
    if (sequence_.running()) playback_.pause(desired);
    playback_.advance(desired, now_s());
    follow_main();
    if (ready_ && !sequence_.running()) history_.observe(desired, gesture);
    post_request();
    post_frame();
    if (!behind()) sequence_.posted(*this);
    picture_ = frames_.latest();
    if (picture_ && picture_->job.revision == posted_job_.revision) shown_sides_ = posted_sides_;
    take_saved();
    take_pick();
    take_preview();
}

void Session::take_outcomes() {
    for (Outcome& outcome : worker_.take()) {
        switch (outcome.kind) {
            case Outcome::Kind::ready:
                if (outcome.whole && !std::exchange(keeps_message_, false)) messages_.dismiss();
                adopt(outcome.ready);
                break;
            case Outcome::Kind::failed:
                messages_.report(outcome.message, outcome.details, outcome.failure);
                playback_.pause(desired);
                if (outcome.lost) note_lost_again();
                if (outcome.files_failed && ready_) {
                    // The worker keeps the old files by itself. A new request would remove the message.
                    const bool asked = is_posted(desired_request());
                    asked_ = *ready_->loaded;
                    waiting_edits_.clear();
                    if (asked) posted_request_ = desired_request();
                }
                break;
            case Outcome::Kind::cancelled:
                log(LogLevel::debug, "work in hand was cancelled");
                break;
        }
    }
}

void Session::adopt(const std::shared_ptr<const Ready>& ready) {
    const std::shared_ptr<const Ready> before = std::exchange(ready_, ready);
    follow_path();
    if (viewed_files_revision_ == ready->loaded->files_revision) return follow_pose(*before);
    const bool same_files = viewed_files_revision_ != 0 && ready->loaded->files_revision == reread_files_revision_;
    viewed_files_revision_ = ready->loaded->files_revision;
    if (same_files) first_edits_ = edits_to_keep(*before);
    for (Word& word : std::exchange(waiting_edits_, {})) first_edits_.push_back(std::move(word));
    const Selection selected = std::exchange(selection, {});
    if (same_files && before->loaded->scene->instances.size() == ready->loaded->scene->instances.size()) selection = selected;
    watch_scene_files();
    apart_.clear();
    middles_ = {};
    const Camera camera = desired.camera;
    const PoseTime pose = desired.pose;
    const CameraPath path = desired.camera_path;
    const std::array<double, 2> loop = desired.loop;
    const float speed = desired.speed;
    playback_.open(*ready->loaded->scene, desired);
    if (!same_files) desired.camera_path = {};
    reset_view();
    if (same_files) {
        desired.camera = camera;
        desired.camera_path = path;
        if (playback_.has(pose.clip)) {
            desired.pose = pose;
            desired.loop = loop;
            desired.speed = speed;
        }
    }
    show_first_pose();
    if (!ready->loaded->view_error.empty()) messages_.report(ready->loaded->view_error);
    first_camera_.clear();
    first_light_.clear();
    EditedView edited = edited_view(desired);
    bool refused = false;
    for (const Word& word : std::exchange(first_edits_, {})) {
        try {
            apply_edit(*ready->loaded->scene, edited, word.key, word.value);
        } catch (const Error& error) {
            messages_.report(error.what());
            refused = true;
        }
    }
    adopt_view(edited);
    // The other edits are prepared next, which is no reason to take the message away.
    if (refused) keeps_message_ = !is_posted(desired_request());
    // The numbers in earlier steps hold for more pictures, too: those of the files come first.
    if (pictures_revision_ != ready->loaded->files_revision) history_.forget();
}

// Shows the pose that the command line asks for.
void Session::show_first_pose() {
    const PoseTime pose = std::exchange(first_pose_, {});
    if (!pose.time_s && pose.clip.empty()) return;
    if (!playback_.any()) return log(LogLevel::warning, "--time: the scene has no clip to play");
    try {
        const ClipInfo clip = find_clip(*ready_->loaded->scene, pose.clip);
        playback_.choose(desired, clip.name);
        desired.pose.time_s = pose.time_s.value_or(clip.begin_s);
    } catch (const Error& error) {
        messages_.report(error.what());
    }
}

void Session::follow_pose(const Ready& before) {
    const auto seen_through = [&](const Camera& camera) { return same_camera(camera, desired.camera); };
    const auto through = std::find_if(before.cameras.begin(), before.cameras.end(), seen_through);
    const auto number = static_cast<size_t>(through - before.cameras.begin());
    if (number < std::min(before.cameras.size(), ready_->cameras.size())) desired.camera = ready_->cameras[number];
    follow_lights(desired, before.lights, ready_->lights);
    history_.lights_moved(before.lights, ready_->lights);
}

// The camera is on its path whenever another time is shown. In between the user may move it, to set another key.
void Session::follow_path() {
    const std::optional<double> time_s = ready_->request.pose.time_s;
    if (std::exchange(path_time_s_, time_s) == time_s || !time_s || desired.camera_path.empty()) return;
    desired.camera = desired.camera_path.at(*time_s);
}

bool Session::behind() const {
    return ready_ && !prepares_same(ready_->request, desired_request());
}

bool Session::not_in_force() const {
    return behind() && is_posted(desired_request()) && !worker_.activity().busy;
}

bool Session::idle() const {
    return !worker_.activity().busy && !worker_.has_outcomes() && is_posted(desired_request()) && !moving_ &&
           !playback_.playing() && frames_.idle() && !inspector_.busy() && pick_request_ == picked_request_ &&
           !sequence_.running() && picture_ == frames_.latest();
}

}  // namespace clarity::ui
