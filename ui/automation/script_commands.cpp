#include "ui/automation/script_commands.hpp"

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "ui/automation/scripted_window.hpp"

namespace clarity::ui {
namespace {

nlohmann::json time_json(const std::optional<double>& time_s) {
    return time_s ? nlohmann::json(*time_s) : nlohmann::json();
}

std::string timeline_text(const Session& session) {
    const DesiredState& desired = session.desired;
    nlohmann::json json = {{"clips", nlohmann::json::array()},
                           {"clip", desired.pose.clip},
                           {"time_s", time_json(desired.pose.time_s)},
                           {"loop", desired.loop},
                           {"speed", desired.speed},
                           {"playing", session.playback().playing()},
                           {"camera_keys", nlohmann::json::array()}};
    for (const CameraKey& key : desired.camera_path.keys) json["camera_keys"].push_back(key.time_s);
    for (const ClipInfo& clip : session.playback().clips()) json["clips"].push_back(clip.name);
    if (const auto picture = session.picture()) json["shown_s"] = time_json(picture->job.ready->request.pose.time_s);
    return json.dump();
}

double number_of(const std::string& text) {
    double number = 0;
    if (!read_number(text, number)) throw Error(Exit::usage, "`" + text + "` is no number");
    return number;
}

void show_time(Session& session, const std::string& text) {
    if (text == "rest") return session.playback().rest(session.desired);
    session.playback().pause(session.desired);
    session.desired.pose.time_s = number_of(text);
}

CompareMode mode_of(const std::string& text) {
    if (text == "wipe") return CompareMode::wipe;
    if (text == "side") return CompareMode::side_by_side;
    if (text == "difference") return CompareMode::difference;
    throw Error(Exit::usage, "no mode `" + text + "`; there are wipe, side, difference");
}

// "x,y,width,height" in shares of the picture, or "off".
std::optional<PicturePart> part_of(const std::string& text) {
    if (text == "off") return std::nullopt;
    const std::vector<float> n = read_numbers<float>(text);
    if (n.size() != 4) throw Error(Exit::usage, "part: expected x,y,width,height or off");
    return PicturePart{n[0], n[1], n[2], n[3]};
}

nlohmann::json json_of(const Rect& rect) {
    return {rect.x, rect.y, rect.width, rect.height};
}

std::string layout_text(ScriptedWindow& window) {
    const PicturePane& pane = window.pane;
    nlohmann::json json = {{"places", nlohmann::json::array()},
                           {"handles", nlohmann::json::array()},
                           {"lines", {pane.lines_drawn(0), pane.lines_drawn(1)}},
                           {"lines_ms", pane.lines_ms()},
                           {"rays", pane.rays_shown()},
                           {"light", window.session.selected_light}};
    for (const PicturePlace& place : pane.places())
        json["places"].push_back({{"area", json_of(place.area)}, {"shown", json_of(place.shown)}, {"side", place.side()}});
    for (const LightHandle& handle : pane.handles())
        json["handles"].push_back({{"x", handle.place.x}, {"y", handle.place.y}, {"kind", static_cast<int>(handle.kind)}});
    return json.dump();
}

}  // namespace

bool run_time_command(ScriptedWindow& window, const std::string& command, const std::string& text) {
    Session& session = window.session;
    Playback& playback = session.playback();
    const bool known = command == "play" || command == "time" || command == "clip" || command == "step" || command == "loop" ||
                       command == "speed" || command == "timeline" || command == "camera_key";
    if (!known) return false;
    if (!playback.any() && command != "timeline" && command != "camera_key") throw Error(Exit::usage, "the scene has no clips");
    if (command == "play") {
        text == "1" ? playback.play(session.desired) : playback.pause(session.desired);
    } else if (command == "time") {
        show_time(session, text);
    } else if (command == "clip") {
        if (!playback.has(text)) throw Error(Exit::usage, "no clip `" + text + "`");
        playback.choose(session.desired, text);
    } else if (command == "step") {
        playback.step(session.desired, static_cast<int>(number_of(text)));
    } else if (command == "loop") {
        const size_t space = text.find(' ');
        if (space == std::string::npos) throw Error(Exit::usage, "`loop A B` needs two times");
        playback.set_loop(session.desired, number_of(text.substr(0, space)), number_of(text.substr(space + 1)));
    } else if (command == "camera_key") {
        text == "remove" ? session.playback().remove_camera_key(session.desired)
                         : session.playback().set_camera_key(session.desired);
    } else if (command == "speed") {
        session.desired.speed = static_cast<float>(number_of(text));
    } else {
        std::printf("%s\n", timeline_text(session).c_str());
    }
    return true;
}

bool run_picture_command(ScriptedWindow& window, const std::string& command, const std::string& text) {
    UiState& state = window.state;
    if (command == "mode")
        state.compare_mode = mode_of(text);
    else if (command == "wipe")
        state.wipe = std::strtof(text.c_str(), nullptr);
    else if (command == "follow")
        state.inspect_hover = text == "1";
    else if (command == "rays")
        state.show_rays = text == "1";
    else if (command == "lights")
        state.show_lights = text == "1";
    else if (command == "part")
        window.session.desired.part = part_of(text);
    else if (command == "behind")
        window.overlay.hide_behind(text == "0");
    else if (command == "layout")
        std::printf("%s\n", layout_text(window).c_str());
    else
        return false;
    return true;
}

}  // namespace clarity::ui
