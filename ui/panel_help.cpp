// The tab of keys, and of how the window itself looks.
#include <imgui.h>

#include <cstring>

#include "ui/panel.hpp"
#include "ui/theme.hpp"
#include "ui/widgets.hpp"

namespace clarity {
namespace {

void key_rows(const KeyMap& map) {
    for (size_t i = 0; i < map.bindings.size();) {
        std::string keys;
        size_t next = i;
        for (; next < map.bindings.size() && std::strcmp(map.bindings[next].help, map.bindings[i].help) == 0; ++next)
            keys += (keys.empty() ? "" : " ") + std::string(map.bindings[next].name);
        if (next - i > 4) keys = std::string(map.bindings[i].name) + " \u2013 " + map.bindings[next - 1].name;
        const float start = ImGui::GetCursorPosX();
        ImGui::PushStyleColor(ImGuiCol_Text, colors::kAccent);
        ImGui::TextUnformatted(keys.c_str());
        ImGui::PopStyleColor();
        ImGui::SameLine(start + 96 * ui_scale());
        ImGui::PushTextWrapPos(0);
        ImGui::TextUnformatted(map.bindings[i].help);
        ImGui::PopTextWrapPos();
        i = next;
    }
}

}  // namespace

void draw_help_tab(UiState& state, const std::string& gl_text) {
    section("KEYS");
    row_label("Key map",
              "thesis: arrows, I K O P for the camera, W A S D for the light; viewer: W A S D walk, the mouse looks");
    if (ImGui::BeginCombo("##keymap", state.key_map->name)) {
        for (const KeyMap& map : key_maps())
            if (ImGui::Selectable(map.name, &map == state.key_map)) state.key_map = &map;
        ImGui::EndCombo();
    }
    ImGui::Dummy({0, 2 * ui_scale()});
    key_rows(*state.key_map);
    section("MOUSE ON THE PICTURE");
    const float column = 96 * ui_scale();
    const std::pair<const char*, const char*> mouse[] = {
        {"Left", state.key_map->mouse_look ? "look around" : "orbit about the target"},
        {"Middle", "shift the view"},
        {"Wheel", "nearer to the target, farther"},
    };
    for (const auto& [button, what] : mouse) {
        const float start = ImGui::GetCursorPosX();
        ImGui::PushStyleColor(ImGuiCol_Text, colors::kAccent);
        ImGui::TextUnformatted(button);
        ImGui::PopStyleColor();
        ImGui::SameLine(start + column);
        ImGui::TextUnformatted(what);
    }
    section("THIS WINDOW");
    row_label("Text size", "on top of what the screen asks for");
    // In force once let go: the slider would grow under the mouse.
    static float shown = 0;
    if (shown == 0) shown = state.text_scale;
    slider("##scale", shown, 0.8f, 2.0f, "%.2f");
    if (ImGui::IsItemDeactivatedAfterEdit()) state.text_scale = shown;
    if (!ImGui::IsItemActive()) shown = state.text_scale;
    dim_text(gl_text);
}

}  // namespace clarity
