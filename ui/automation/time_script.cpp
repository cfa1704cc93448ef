#include "ui/automation/time_script.hpp"

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

}  // namespace clarity::ui
