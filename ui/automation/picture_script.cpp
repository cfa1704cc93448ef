#include "ui/automation/picture_script.hpp"

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "ui/automation/scripted_window.hpp"

namespace clarity::ui {
namespace {

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
