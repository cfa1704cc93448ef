// The Help tab: first steps, keys, and the look of the window.
#include <imgui.h>

#include "ui/hud/keys_hud.hpp"
#include "ui/panel/panel.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

void step(const char* what, const char* how) {
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kAccent);
    ImGui::TextUnformatted(what);
    ImGui::PopStyleColor();
    ImGui::Indent(12 * ui_scale());
    wrapped_text(how);
    ImGui::Unindent(12 * ui_scale());
}

}  // namespace

void draw_help_tab(UiState& state, const std::string& gl_text) {
    if (folding_section("FIRST STEPS")) {
        step("Open a file", "Open\u2026 above the tabs, or drop files onto the window.");
        step("Change the structure", "Render > Structure; its own parameters are below it.");
        step("See the volumes", "Volumes above the tabs; keys 1 to 9 choose the level, 0 the bottom one.");
        step("Compare two structures", "Compare above the tabs, then choose another Structure: the rows now change side B.");
        step("See the rays of a pixel", "Inspect above the tabs, then move over the picture.");
        step("Save the picture", "Save above the tabs, or Render > Save for PNG, EXR and a path of your own.");
    }
    section("KEYS");
    row_label("Key map",
              "thesis: arrows, I K O P for the camera, W A S D for the light; viewer: W A S D walk, the mouse looks");
    if (ImGui::BeginCombo("##keymap", state.key_map->name)) {
        for (const KeyMap& map : key_maps())
            if (option(map.name, &map == state.key_map)) state.key_map = &map;
        ImGui::EndCombo();
    }
    if (button("All keys over the picture", "F1", -FLT_MIN)) state.keys_open = true;
    draw_key_table(state);
    section("THIS WINDOW");
    row_label("Text size", "factor on top of the screen's own scale");
    // The scale applies when the slider is released. Otherwise the slider would grow under the mouse.
    static float shown = 0;
    if (shown == 0) shown = state.text_scale;
    slider("##scale", shown, 0.8f, 2.0f, "%.2f");
    if (ImGui::IsItemDeactivatedAfterEdit()) state.text_scale = shown;
    if (!ImGui::IsItemActive()) shown = state.text_scale;
    dim_text(gl_text);
}

}  // namespace clarity::ui
