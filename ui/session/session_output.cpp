#include "ui/session/session_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "base/error.hpp"
#include "base/log.hpp"
#include "view/edit/edit.hpp"
#include "view/settings/aov.hpp"

namespace clarity::ui {

void Session::take_saved() {
    for (const FrameThread::Saved& saved : frames_.take_saved()) {
        if (saved.failure.empty())
            log(LogLevel::info, "saved " + saved.path);
        else
            messages_.report(saved.failure);
        sequence_.saved(*this, saved.number, saved.failure.empty());
    }
}

uint64_t Session::save_picture(const std::string& path) {
    check_output_path(path);
    if (!ready_) throw Error(Exit::usage, path + ": cannot save, because there is no picture yet; open a scene first");
    post_frame();  // the command is that of the posted job
    return frames_.save(path, render_command(path));
}

Preset Session::desired_preset(EditedView base) const {
    Preset preset{desired.main.device, desired.main.settings, {}};
    if (!find_aov(preset.settings.aov).adds_samples()) preset.settings.spp = 1;  // as in post_frame()
    if (desired.pose.time_s) {
        preset.pose = desired.pose;
        // Lights for a scene that has none suit its size, which is another in another pose. So they are always named.
        if (ready_ && ready_->loaded->scene->lights.empty())
            for (rt_light& light : base.view.lights) light.color[0] = -1;
    }
    if (ready_) preset.edits = edits_between(*ready_->loaded->scene, base, edited_view(desired));
    return preset;
}

void Session::save_preset(const std::string& path) const {
    clarity::save_preset(plugins_, desired_preset(ready_ ? first_view() : EditedView()), path);
}

void Session::load_preset(const std::string& path) {
    const Preset preset = clarity::load_preset(plugins_, path);
    if (!ready_ && !preset.edits.empty())
        throw Error(Exit::usage,
                    path + ": this preset changes the view of a scene, but no scene is open; open the scene first");
    EditedView edited;
    if (ready_) {
        edited = first_view();
        for (const Word& word : preset.edits)
            if (!waits_for_picture(word)) apply_edit(*ready_->loaded->scene, edited, word.key, word.value);
    }
    desired.main = {preset.device.empty() ? desired.main.device : preset.device, preset.settings};
    if (ready_) adopt_view(edited);
    if (ready_ && playback_.any()) {
        playback_.rest(desired);
        if (preset.pose.time_s && playback_.has(preset.pose.clip)) {
            playback_.choose(desired, preset.pose.clip);
            desired.pose.time_s = preset.pose.time_s;
        }
        // A camera that has left its path stays where the preset has it.
        if (!edited.follows_path) path_time_s_ = desired.pose.time_s;
    }
    log(LogLevel::info, "preset " + path);
}

std::string scene_path(const Session& session) {
    const std::shared_ptr<const Ready> ready = session.ready();
    if (!ready) return {};
    const std::filesystem::path first = ready->loaded->files.front();
    if (ready->loaded->files.size() == 1 && first.extension() == ".scene") return first.string();
    return (first.parent_path() / (first.stem().string() + "_edited.scene")).string();
}

void save_scene(const Session& session, const std::string& path) {
    const std::shared_ptr<const Ready> ready = session.ready();
    if (!ready) throw Error(Exit::usage, path + ": cannot save, because no scene is open; open a scene first");
    const EditedView edited = edited_view(session.desired);
    clarity::save_scene({*ready->loaded->scene, ready->loaded->files, edited}, path);
    log(LogLevel::info, "saved " + path);
    std::vector<std::string> files = ready->loaded->files;
    for (const std::string& picture : given_pictures(*ready->loaded->scene, edited.maps)) files.push_back(picture);
    for (const std::string& folder : folders_outside(files, path))
        log(LogLevel::warning, path + ": it loads files outside of its folder; open it with --search-path '" + folder + "'");
}

std::string Session::render_command(const std::string& output) const {
    if (!ready_) throw Error(Exit::usage, "there is no command line, because no scene is open; open a scene first");
    // Starts from the defaults of the command line, whatever options this window was started with.
    Preset preset;
    const Settings& s = desired.main.settings;
    const auto scaled = [&](int n) { return std::max(1, static_cast<int>(std::lround(n * desired.resolution_scale))); };
    const int width = scaled(s.width), height = scaled(s.height);
    EditedView base;
    base.view = make_view(*ready_->loaded->scene, static_cast<float>(width) / static_cast<float>(height));
    for (size_t i = 0; i < ready_->lights.size(); ++i) base.view.lights[i] = ready_->lights[i].values;
    apply_scene_edits(*ready_->loaded->scene, base);
    preset = desired_preset(base);
    preset.settings.width = width;
    preset.settings.height = height;
    preset.device = ready_->main.devices_text();
    std::vector<std::string> files = ready_->loaded->files;
    for (std::string& file : files) file = std::filesystem::absolute(file).lexically_normal().string();
    const std::string command = clarity::render_command(plugins_, preset, files, output);
    return desired.part ? command + " --crop " + crop_text(*desired.part, width, height) : command;
}

double frames_per_second(const Session& session, unsigned side) {
    const std::vector<float> times = session.frame_times(side).frames_ms();
    const size_t count = std::min<size_t>(times.size(), 10);
    double sum = 0;
    for (size_t i = times.size() - count; i < times.size(); ++i) sum += times[i];
    return sum > 0 ? 1000.0 * static_cast<double>(count) / sum : 0.0;
}

double mrays_per_second(const Session& session, unsigned side) {
    const std::shared_ptr<const Picture> picture = session.picture();
    if (!picture || (side == 1 && !picture->other)) return 0;
    const FrameStats& stats = side == 1 ? picture->other->stats : picture->main.stats;
    const double ms = stats.device_ms > 0 ? stats.device_ms : stats.wall_ms;
    return ms > 0 ? static_cast<double>(stats.primary + stats.shadow + stats.secondary) / ms * 1e-3 : 0;
}

std::string frame_rate_line(const Session& session) {
    const std::shared_ptr<const Picture> picture = session.picture();
    if (!picture) return "fps 0.0  no picture yet";
    const Settings& s = picture->main.settings;
    const double fps = frames_per_second(session);
    char text[256];
    std::snprintf(text, sizeof text, "fps %.1f  %.1f ms  %.1f Mrays/s  %dx%d  %s  packet %dx%d  lanes %d  depth %d", fps,
                  fps > 0 ? 1000.0 / fps : 0.0, mrays_per_second(session), s.width, s.height, s.accel.c_str(), s.packet_w,
                  s.packet_h, s.lanes, s.depth);
    return text;
}

}  // namespace clarity::ui
