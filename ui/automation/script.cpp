#include "ui/automation/script.hpp"

#include <fcntl.h>
#include <imgui.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>

#include "base/error.hpp"
#include "base/pictures/image_io.hpp"
#include "plugin/parameters.hpp"
#include "ui/automation/script_commands.hpp"
#include "ui/automation/scripted_window.hpp"
#include "ui/session/session_output.hpp"
#include "ui/viewport/picture_captions.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

std::string rest_of(std::istringstream& in) {
    std::string text;
    std::getline(in >> std::ws, text);
    return text;
}

void choose_accel(Session& session, const std::string& text) {
    const PluginChoice choice = parse_plugin_choice(text);
    const Settings before = session.edited().settings;
    session.set_accel(choice.id);
    try {
        for (const auto& [key, value] : choice.settings)
            set_parameter(*session.plugins().accel(choice.id), session.edited().settings.accel_params, key, value);
    } catch (const Error&) {
        session.edited().settings = before;
        throw;
    }
}

nlohmann::json convergence_json(const Convergence& convergence) {
    nlohmann::json json = {{"slope", convergence.slope()}, {"points", nlohmann::json::array()}};
    for (const Convergence::Point& point : convergence.points()) {
        json["points"].push_back({point.samples, point.seconds, point.error});
        if (std::isfinite(point.rmse)) json["rmse"].push_back(point.rmse);
    }
    return json;
}

nlohmann::json caption_json(const Caption& caption) {
    return {{"speed", caption.speed}, {"noise", caption.noise}, {"verdict", caption.verdict}};
}

long resident_kilobytes() {
    std::ifstream statm("/proc/self/statm");
    long total = 0, resident = 0;
    statm >> total >> resident;
    return resident * (sysconf(_SC_PAGESIZE) / 1024);
}

// Applies a change of the view in the words of edit.hpp: "background 1,0,0".
void edit(Session& session, const std::string& text) {
    const size_t space = text.find(' ');
    session.apply({text.substr(0, space), space == std::string::npos ? "" : text.substr(space + 1)});
}

std::string inspection_text(const Session& session) {
    const auto inspection = session.inspector().latest();
    if (!inspection) throw Error(Exit::failed, "no pixel was inspected");
    if (!inspection->failure.empty()) throw Error(Exit::failed, inspection->failure);
    nlohmann::json json = {{"x", inspection->x}, {"y", inspection->y}, {"rays", nlohmann::json::array()}};
    for (const RayRecord& ray : inspection->result.rays)
        json["rays"].push_back({{"kind", static_cast<int>(ray.kind)},
                                {"parent", ray.parent},
                                {"t", std::isfinite(ray.t) ? nlohmann::json(ray.t) : nlohmann::json()},
                                {"prim", ray.prim}});
    return json.dump();
}

std::string noise_text(const Session& session) {
    const auto noise = session.inspector().latest_noise();
    if (!noise) throw Error(Exit::failed, "no pixel was explained");
    if (!noise->failure.empty()) throw Error(Exit::failed, noise->failure);
    const NoiseReport& report = noise->report;
    return nlohmann::json{{"x", noise->x},
                          {"y", noise->y},
                          {"cause", name_of(report.cause)},
                          {"sentence", report.sentence},
                          {"samples", report.samples},
                          {"mean", report.mean}}
        .dump();
}

std::vector<std::string> dropped_files(const std::string& text) {
    try {
        return nlohmann::json::parse(text).get<std::vector<std::string>>();
    } catch (const nlohmann::json::exception&) {
        throw Error(Exit::usage, "`" + text + "` is no array of paths");
    }
}

void choose_tab(UiState& state, const std::string& name) {
    for (int i = 0; i < kTabCount; ++i)
        if (name == kTabNames[i]) return state.show_tab(static_cast<Tab>(i));
    throw Error(Exit::usage, "no tab `" + name + "`");
}

void choose_map(UiState& state, const std::string& id) {
    const KeyMap* map = find_key_map(id);
    if (!map) throw Error(Exit::usage, "no key map `" + id + "`");
    state.key_map = map;
}

using Window = ScriptedWindow;

void set(Window& window, const std::string& text) {
    const size_t space = text.find(' ');
    const std::string key = text.substr(0, space);
    set_setting(window.session.settings_for(key), key, space == std::string::npos ? "" : text.substr(space + 1));
}

// "X Y"
std::array<unsigned, 2> pixel_of(const std::string& text) {
    std::array<unsigned, 2> pixel{};
    std::istringstream(text) >> pixel[0] >> pixel[1];
    return pixel;
}

void show_level(Window& window, const std::string& text) {
    if (text == "off")
        window.overlay.show(std::nullopt);
    else
        window.overlay.show(text == "bottom" ? RT_LEVEL_BOTTOM : static_cast<rt_u32>(std::strtoul(text.c_str(), nullptr, 10)));
}

void compare(Window& window, const std::string& text) {
    window.session.compare(text != "off");
    window.session.editing_other = text == "b";
}

void write_picture(Window& window, const std::string& path) {
    if (!window.session.picture()) throw Error(Exit::failed, "no picture yet");
    write_image(path, {}, window.session.picture()->main.image);
}

void write_preview(Window& window, const std::string& path) {
    const auto preview = window.session.preview();
    if (!preview || preview->image.width == 0) throw Error(Exit::failed, "no preview yet");
    write_image(path, {}, preview->image);
}

struct Command {
    const char* name;
    void (*run)(Window& window, const std::string& text);
};
const Command kCommands[] = {
    {"set", set},
    {"accel", [](Window& w, const std::string& text) { choose_accel(w.session, text); }},
    {"device", [](Window& w, const std::string& text) { w.session.edited().device = text; }},
    {"open", [](Window& w, const std::string& text) { w.session.open({text}); }},
    {"drop", [](Window& w, const std::string& text) { w.drop(dropped_files(text)); }},
    {"moving_fps",
     [](Window& w, const std::string& text) { w.session.desired.moving_fps = std::strtof(text.c_str(), nullptr); }},
    {"double_click", [](Window& w, const std::string& text) { w.set_double_click(std::strtof(text.c_str(), nullptr)); }},
    {"cancel", [](Window& w, const std::string&) { w.session.cancel(); }},
    {"edit", [](Window& w, const std::string& text) { edit(w.session, text); }},
    {"compare", compare},
    {"swap", [](Window& w, const std::string&) { w.session.swap_sides(); }},
    {"undo", [](Window& w, const std::string&) { w.session.undo(); }},
    {"redo", [](Window& w, const std::string&) { w.session.redo(); }},
    {"save_preset", [](Window& w, const std::string& text) { w.session.save_preset(text); }},
    {"load_preset", [](Window& w, const std::string& text) { w.session.load_preset(text); }},
    {"command_line",
     [](Window& w, const std::string& text) {
         std::printf("%s\n", nlohmann::json{{"command", w.session.render_command(text)}}.dump().c_str());
     }},
    {"save", [](Window& w, const std::string& text) { w.session.save_picture(text); }},
    {"turntable",
     [](Window& w, const std::string& text) {
         w.session.sequence().start_turntable(w.session, text.substr(text.find(' ') + 1), std::atoi(text.c_str()));
     }},
    {"inspect", [](Window& w, const std::string& text) { w.session.inspect(pixel_of(text)[0], pixel_of(text)[1]); }},
    {"pick", [](Window& w, const std::string& text) { w.session.pick(pixel_of(text)[0], pixel_of(text)[1]); }},
    {"why", [](Window& w, const std::string& text) { w.session.explain(pixel_of(text)[0], pixel_of(text)[1]); }},
    {"noise", [](Window& w, const std::string&) { std::printf("%s\n", noise_text(w.session).c_str()); }},
    {"inspection", [](Window& w, const std::string&) { std::printf("%s\n", inspection_text(w.session).c_str()); }},
    {"continuous", [](Window& w, const std::string& text) { w.session.desired.continuous = text == "1"; }},
    {"save_scene", [](Window& w, const std::string& text) { save_scene(w.session, text); }},
    {"select",
     [](Window& w, const std::string& text) {
         w.session.selection = {static_cast<rt_i32>(std::strtol(text.c_str(), nullptr, 10)), -1, -1};
     }},
    {"handles", [](Window& w, const std::string& text) { w.state.move_handles = text == "1"; }},
    {"tab", [](Window& w, const std::string& text) { choose_tab(w.state, text); }},
    {"map", [](Window& w, const std::string& text) { choose_map(w.state, text); }},
    {"level", show_level},
    {"focus",
     [](Window& w, const std::string&) {
         w.state.show_tab(Tab::scene);
         w.state.focus_path_asked = true;
     }},
    {"scale", [](Window& w, const std::string& text) { w.state.text_scale = std::strtof(text.c_str(), nullptr); }},
    {"screenshot", [](Window& w, const std::string& text) { w.capture(text); }},
    {"picture", write_picture},
    {"preview", write_preview},
    {"quit", [](Window& w, const std::string&) { w.close(); }},
};

}  // namespace

std::unique_ptr<Script> Script::from_environment() {
    const char* path = std::getenv("CLARITY_UI_SCRIPT");
    if (!path || !*path) return nullptr;
    // Opening a pipe would block until it has a writer.
    const int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0)
        throw Error(Exit::usage, std::string(path) + ": cannot be read as the window's script: " + std::strerror(errno));
    return std::make_unique<Script>(file);
}

Script::~Script() {
    close(file_);
}

void Script::read_lines() {
    char buffer[4096];
    for (;;) {
        const ssize_t bytes = read(file_, buffer, sizeof buffer);
        if (bytes <= 0) return;
        partial_.append(buffer, static_cast<size_t>(bytes));
        for (size_t end; (end = partial_.find('\n')) != std::string::npos; partial_.erase(0, end + 1))
            lines_.push_back(partial_.substr(0, end));
    }
}

bool Script::has_lines() {
    read_lines();
    return !lines_.empty();
}

void Script::step(ScriptedWindow& window) {
    read_lines();
    while (!lines_.empty()) {
        const std::string line = lines_.front();
        std::string answer = "ok " + line;
        try {
            if (!run(window, line)) return;
        } catch (const Error& error) {
            answer = "error " + line + ": " + error.what();
        }
        waiting_since_ = 0;
        waits_for_work_ = false;
        lines_.pop_front();
        std::printf("%s\n", answer.c_str());
        std::fflush(stdout);
        return;  // one command a frame, so that its effect is drawn before the next command
    }
}

bool Script::wait(ScriptedWindow& window, const std::string& text) {
    std::istringstream in(text);
    std::string what;
    double limit = 60;
    in >> what >> limit;
    if (in.fail()) limit = 60;
    const double now = ImGui::GetTime();
    if (waiting_since_ == 0) {
        waiting_since_ = now;
        frames_left_ = 2;
    }
    const Session& session = window.session;
    const bool busy = session.activity().busy;
    const bool met = what == "busy"    ? busy
                     : what == "ready" ? !busy && !session.behind()
                                       : session.idle() && window.overlay.ready();
    if (met && (what == "busy" || --frames_left_ < 0)) return true;
    if (!met) frames_left_ = 2;
    waits_for_work_ = !met && what != "busy";
    if (now - waiting_since_ > limit) throw Error(Exit::failed, "still waiting after " + std::to_string(limit) + " s");
    return false;
}

bool Script::run(ScriptedWindow& window, const std::string& line) {
    std::istringstream in(line);
    std::string command;
    in >> command;
    const std::string text = rest_of(in);
    if (command.empty() || command[0] == '#') return true;
    if (command == "wait") return wait(window, text);
    if (command == "find") return find(text);
    if (command == "state") {
        if (text == "reset") window.times = {};
        std::printf("%s\n", state_text(window).c_str());
        return true;
    }
    const auto* const row =
        std::find_if(std::begin(kCommands), std::end(kCommands), [&](const Command& known) { return command == known.name; });
    if (row != std::end(kCommands))
        row->run(window, text);
    else if (!run_picture_command(window, command, text) && !run_time_command(window, command, text))
        throw Error(Exit::usage, "no such command");
    return true;
}

bool Script::find(const std::string& label) {
    const Rect* place = drawn_rect(label);
    // A rectangle that is scrolled out of sight is scrolled into view within the next frames.
    if (!place && waiting_since_ == 0) {
        waiting_since_ = ImGui::GetTime();
        frames_left_ = 4;
    }
    if (!place && frames_left_-- > 0) return false;
    if (!place) throw Error(Exit::failed, "not drawn");
    std::printf("%s\n",
                nlohmann::json{{"x", place->x}, {"y", place->y}, {"w", place->width}, {"h", place->height}}.dump().c_str());
    return true;
}

std::string Script::state_text(ScriptedWindow& window) const {
    Session& session = window.session;
    const Rect& area = window.pane.area();
    nlohmann::json json = {{"eye", session.desired.camera.eye},
                           {"target", session.desired.camera.target},
                           {"busy", session.activity().busy},
                           {"stage", session.activity().stage},
                           {"behind", session.behind()},
                           {"message", session.messages().shown().text},
                           {"messages", session.messages().count()},
                           {"path", window.state.path},
                           {"map", window.state.key_map->id},
                           {"typing", ImGui::GetIO().WantTextInput},
                           {"volumes", window.overlay.count()},
                           {"fps", frames_per_second(session)},
                           {"ui_frames", window.times.frames},
                           {"slowest_frame_ms", window.times.slowest_frame_ms},
                           {"slowest_answer_ms", window.times.slowest_answer_ms},
                           {"area", {area.x, area.y, area.width, area.height}},
                           {"files", session.files()}};
    json["level"] = window.overlay.level() ? static_cast<long>(*window.overlay.level()) : -1L;
    if (session.selected_light < session.desired.lights.size())
        json["light"] = session.desired.lights[session.selected_light].values.position;
    json["selected"] = {
        {"prim", session.selection.prim}, {"instance", session.selection.instance}, {"material", session.selection.material}};
    json["hidden"] = session.desired.instances.hidden;
    json["moved"] = nlohmann::json::array();
    for (const InstanceEdits::Moved& moved : session.desired.instances.moved)
        json["moved"].push_back({{"instance", moved.instance},
                                 {"translate", moved.shift.translate},
                                 {"rotate", moved.shift.degrees},
                                 {"scale", moved.shift.scale}});
    json["move_handles"] = window.state.move_handles;
    if (const auto ready = session.ready()) {
        const PoseUpdate& update = ready->main.pose_update;
        json["update"] = {{"followed", update.followed},
                          {"refitted", update.refitted},
                          {"why", update.why},
                          {"ms", update.ms},
                          {"building", update.building}};
        for (const TreeUpdate& tree : update.trees)
            json["update"]["trees"].push_back({{"name", tree.name},
                                               {"what", tree.what},
                                               {"primitives", tree.primitives},
                                               {"cost_ratio", tree.cost_ratios.back()}});
    }
    if (const auto preview = session.preview())
        json["preview"] = {{"material", preview->material},
                           {"samples", preview->samples},
                           {"failure", preview->failure},
                           {"done", preview->done}};
    json["undo"] = session.history().undo_name();
    json["redo"] = session.history().redo_name();
    json["kernel_revision"] = session.sources_revision();
    json["comparing"] = session.desired.other.has_value();
    json["bookmarks"] = window.state.bookmarks.size();
    json["keys_open"] = window.state.keys_open;
    json["browser_open"] = window.state.browser_open;
    json["panel_visible"] = window.state.panel_visible;
    json["inspect_hover"] = window.state.inspect_hover;
    json["show_lights"] = window.state.show_lights;
    json["compare_mode"] = kCompareNames[static_cast<int>(window.state.compare_mode)];
    json["wipe"] = window.state.wipe;
    json["resident_kb"] = resident_kilobytes();
    if (const auto picture = session.picture(); picture && picture->other) {
        json["other"] = {{"accel", picture->other->settings.accel},
                         {"depth", picture->other->settings.depth},
                         {"samples", picture->other->stats.samples},
                         {"frame_ms", picture->other->frame_ms},
                         {"convergence", convergence_json(picture->other->convergence)},
                         {"caption", caption_json(caption_of(session, *picture, 1))}};
        json["caption"] = caption_json(caption_of(session, *picture, 0));
        if (picture->difference)
            json["difference"] = {{"share", picture->difference->share}, {"largest", picture->difference->largest}};
    }
    if (const auto picture = session.picture()) {
        const Settings& s = picture->main.settings;
        json["aov"] = s.aov;
        json["reduced"] = picture->reduced;
        json["denoised"] = denoises(s);
        json["device"] = picture->job.ready->main.devices_text();
        json["accel"] = s.accel;
        json["packet"] = std::to_string(s.packet_w) + "x" + std::to_string(s.packet_h);
        json["lanes"] = s.lanes;
        json["depth"] = s.depth;
        json["size"] = std::to_string(s.whole_width()) + "x" + std::to_string(s.whole_height());
        json["samples"] = picture->main.stats.samples;
        json["convergence"] = convergence_json(picture->main.convergence);
        json["spp"] = s.spp;
        json["triangles"] = picture->job.ready->loaded->placed_triangles;
        json["primary"] = picture->main.stats.primary;
    }
    return json.dump();
}

}  // namespace clarity::ui
