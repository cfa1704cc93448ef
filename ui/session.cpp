#include "ui/session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "base/log.hpp"
#include "plugin/parameters.hpp"

namespace clarity {
namespace {

bool same_view(const View& a, const View& b) {
    const bool cameras = a.camera.eye == b.camera.eye && a.camera.target == b.camera.target && a.camera.up == b.camera.up &&
                         a.camera.fov_y_rad == b.camera.fov_y_rad;
    return cameras && a.background == b.background && a.ambient == b.ambient && a.lights.size() == b.lights.size() &&
           std::equal(a.lights.begin(), a.lights.end(), b.lights.begin(),
                      [](const rt_light& x, const rt_light& y) { return std::memcmp(&x, &y, sizeof x) == 0; });
}

// Exposure and tone map what is in the film already; every other setting of a frame, but for the count of samples, traces it
// anew.
bool only_displays(const std::string& key) {
    return key == "exposure" || key == "tone";
}

std::string frame_key(const Settings& settings, bool displaying) {
    std::string key;
    for (const Setting& row : settings_table())
        if (row.effect == Effect::frame && row.key != "spp" && only_displays(row.key) == displaying)
            key += row.key + "=" + row.get(settings) + ";";
    return key;
}

std::string prepare_key(const Settings& settings) {
    std::string key = settings.accel;
    for (const double value : settings.accel_params) key += "," + std::to_string(value);
    for (const Setting& row : settings_table())
        if (row.effect != Effect::frame) key += ";" + row.key + "=" + row.get(settings);
    return key;
}

}  // namespace

Session::Session(const ViewOptions& options, std::function<void()> wake)
    : plugins_(*options.plugins),
      first_camera_(options.camera),
      first_light_(options.light),
      log_(wake),
      worker_(plugins_, options.import, wake),
      frames_(wake) {
    wish.device = options.device;
    wish.settings = options.settings;
    if (wish.settings.accel_params.empty())
        if (const rt_plugin* accel = plugins_.accel(wish.settings.accel))
            wish.settings.accel_params = default_parameters(*accel);
    if (!options.scenes.empty()) open(options.scenes);
}

void Session::open(std::vector<std::string> files) {
    files_ = std::move(files);
    files_revision_ = ++last_files_revision_;
}

void Session::set_accel(const std::string& id) {
    const rt_plugin* plugin = plugins_.accel(id);
    if (!plugin) throw Error(Exit::usage, "no acceleration structure `" + id + "` among the plugins");
    wish.settings.accel = id;
    wish.settings.accel_params = default_parameters(*plugin);
}

std::vector<std::string> Session::files() const {
    return ready_ ? ready_->loaded->files : std::vector<std::string>();
}

void Session::cancel() {
    worker_.cancel();
    if (!ready_) return;
    wish.device = ready_->request.device;
    const Settings now = wish.settings;
    wish.settings = ready_->request.settings;
    for (const Setting& row : settings_table())
        if (row.effect == Effect::frame) row.set(wish.settings, row.get(now));
    files_ = ready_->request.files;
    files_revision_ = ready_->request.files_revision;
    posted_key_ = request_key();  // it is what we have: nothing to ask for
}

std::string Session::request_key() const {
    return std::to_string(files_revision_) + "|" + wish.device + "|" + prepare_key(wish.settings);
}

void Session::post_request() {
    const std::string key = request_key();
    if (key == posted_key_) return;
    posted_key_ = key;
    worker_.request({files_, files_revision_, wish.device, first_camera_, first_light_, wish.settings});
}

View Session::wished_view() const {
    View view;
    view.camera = wish.camera;
    for (const WishedLight& light : wish.lights)
        if (light.on) view.lights.push_back(light.values);
    view.background = wish.background;
    view.ambient = wish.ambient;
    return view;
}

void Session::post_frame() {
    if (!ready_) return;
    FrameJob job{ready_, wish.settings, wished_view(), posted_job_.revision, posted_job_.display_revision, wish.continuous};
    const bool first = !posted_job_.ready;
    const bool anew = first || job.ready != posted_job_.ready || !same_view(job.view, posted_job_.view) ||
                      frame_key(job.settings, false) != frame_key(posted_job_.settings, false) ||
                      job.settings.spp < posted_job_.settings.spp;
    const bool shown = first || frame_key(job.settings, true) != frame_key(posted_job_.settings, true);
    const bool other = job.settings.spp != posted_job_.settings.spp || job.continuous != posted_job_.continuous;
    if (!anew && !shown && !other) return;
    job.revision += anew;
    job.display_revision += shown;
    posted_job_ = job;
    frames_.post(std::move(job));
}

void Session::update() {
    take_outcomes();
    if (auto why = frames_.take_failure(); !why.empty()) report(why);
    post_request();
    post_frame();
    picture_ = frames_.latest();
}

void Session::take_outcomes() {
    for (Outcome& outcome : worker_.take()) {
        switch (outcome.kind) {
            case Outcome::Kind::ready:
                if (outcome.whole) message_ = {};
                adopt(outcome.ready);
                break;
            case Outcome::Kind::failed:
                report(outcome.message, outcome.details);
                if (outcome.files_failed && ready_) files_ = ready_->loaded->files;
                break;
            case Outcome::Kind::cancelled:
                log(LogLevel::debug, "work in hand was cancelled");
                break;
        }
    }
}

void Session::adopt(const std::shared_ptr<const Ready>& ready) {
    ready_ = ready;
    ready_key_ = std::to_string(ready->request.files_revision) + "|" + ready->request.device + "|" +
                 prepare_key(ready->request.settings);
    if (viewed_files_revision_ == ready->loaded->files_revision) return;
    viewed_files_revision_ = ready->loaded->files_revision;
    reset_view();
    if (!ready->loaded->view_error.empty()) report(ready->loaded->view_error);
    first_camera_.clear();
    first_light_.clear();
    for (const std::string& warning : ready->loaded->scene->warnings) log(LogLevel::warning, warning);
}

void Session::reset_view() {
    if (!ready_) return;
    const Scene& scene = *ready_->loaded->scene;
    const View& view = ready_->loaded->first_view;
    wish.camera = view.camera;
    wish.background = view.background;
    wish.ambient = view.ambient;
    wish.lights.clear();
    selected_light = 0;
    for (size_t i = 0; i < view.lights.size(); ++i) {
        std::string name = i < scene.lights.size() ? scene.lights[i].name : "";
        if (name.empty()) name = "light " + std::to_string(i + 1);
        wish.lights.push_back({name, view.lights[i], true});
    }
}

void Session::report(const std::string& text, const std::string& details) {
    log(LogLevel::error, details.empty() ? text : text + "\n" + details);
    message_ = {text, details};
    ++message_count_;
}

bool Session::behind() const {
    return ready_ && ready_key_ != request_key();
}

bool Session::idle() const {
    return !worker_.activity().busy && posted_key_ == request_key() && frames_.idle() && picture_ == frames_.latest();
}

float Session::scene_size() const {
    const float diagonal = ready_ ? ready_->loaded->bounds.diagonal() : 0.0f;
    if (diagonal > 0) return diagonal;
    float squared = 0;  // planes only, or nothing: the distance looked at
    for (int i = 0; i < 3; ++i)
        squared += (wish.camera.target[i] - wish.camera.eye[i]) * (wish.camera.target[i] - wish.camera.eye[i]);
    return std::max(std::sqrt(squared), 1e-3f);
}

double Session::frames_per_second() const {
    const std::vector<float> times = frames_.times();
    const size_t count = std::min<size_t>(times.size(), 10);
    double sum = 0;
    for (size_t i = times.size() - count; i < times.size(); ++i) sum += times[i];
    return sum > 0 ? 1000.0 * static_cast<double>(count) / sum : 0.0;
}

double Session::mrays_per_second() const {
    if (!picture_) return 0;
    const FrameStats& stats = picture_->stats;
    const double ms = stats.device_ms > 0 ? stats.device_ms : stats.wall_ms;
    return ms > 0 ? static_cast<double>(stats.primary + stats.shadow + stats.secondary) / ms * 1e-3 : 0;
}

std::string Session::frame_rate_line() const {
    if (!picture_) return "fps 0.0  no picture yet";
    const Settings& s = picture_->job.settings;
    const double fps = frames_per_second();
    char text[256];
    std::snprintf(text, sizeof text, "fps %.1f  %.1f ms  %.1f Mrays/s  %dx%d  %s  packet %dx%d  lanes %d  depth %d", fps,
                  fps > 0 ? 1000.0 / fps : 0.0, mrays_per_second(), s.width, s.height, s.accel.c_str(), s.packet_w, s.packet_h,
                  s.lanes, s.depth);
    return text;
}

}  // namespace clarity
