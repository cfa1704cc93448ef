// The toolbar above the tabs: what a newcomer looks for first. Open a file, save the picture, volumes, comparison, rays of a
// pixel.
#include <imgui.h>

#include "ui/panel/panel.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

void step_button(const char* sign, bool can, const std::string& help, float width, const std::function<void()>& act) {
    ImGui::BeginDisabled(!can);
    if (button(sign, help, width)) act();
    ImGui::EndDisabled();
}

void toggle_volumes(VolumeOverlay& overlay, UiState& state) {
    if (overlay.level())
        overlay.show(std::nullopt);
    else
        overlay.show(state.last_level);
}

}  // namespace

void draw_toolbar(Session& session, VolumeOverlay& overlay, UiState& state) {
    if (overlay.level()) state.last_level = *overlay.level();
    const float scale = ui_scale();
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(4 * scale, ImGui::GetStyle().ItemSpacing.y));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(5 * scale, ImGui::GetStyle().FramePadding.y));
    const char* const words[] = {"Open\u2026", "Save", "Volumes", "Compare", "Inspect"};
    float needed = 0;
    for (const char* word : words) needed += ImGui::CalcTextSize(word).x + 14 * scale;
    const float step = 26 * scale, room = ImGui::GetContentRegionAvail().x;
    const float spare = room - needed - 2 * (step + 4 * scale);
    const bool one_line = spare >= 0;
    const float wider = one_line ? spare / 5 : (room - needed) / 5;
    const auto width = [&](int i) { return ImGui::CalcTextSize(words[i]).x + 10 * scale + wider; };
    if (button(words[0], "open a model or a scene (Ctrl+O); files can also be dropped onto the window", width(0)))
        state.browse(BrowseFor::scene);
    ImGui::SameLine();
    if (button(words[1],
               "save the picture as the next free number in the folder of pictures (Ctrl+S); more under Render > Save",
               width(1)))
        attempt(session, [&] { session.save_picture(next_picture_path(state.pictures_folder)); });
    ImGui::SameLine();
    if (toggle_button(words[2], overlay.level().has_value(),
                      "draw the structure's bounding volumes over the picture; keys 1 to 9 choose the level, 0 the bottom one",
                      width(2)))
        toggle_volumes(overlay, state);
    ImGui::SameLine();
    if (toggle_button(words[3], session.desired.other.has_value(),
                      "a second picture with settings of its own, beside or over the first (C): another structure, say",
                      width(3))) {
        session.compare(!session.desired.other);
        session.editing_other = session.desired.other.has_value();  // the next changes are to be on the second side
        if (session.desired.other) state.show_tab(Tab::render);
    }
    ImGui::SameLine();
    if (toggle_button(words[4], state.inspect_hover, "follow the rays of the pixel under the mouse (R)", width(4))) {
        state.inspect_hover = !state.inspect_hover;
        if (state.inspect_hover) state.show_tab(Tab::inspect);
    }
    if (one_line) ImGui::SameLine();
    const History& history = session.history();
    const auto help = [](const char* what, const std::string& name, const char* key) {
        return name.empty() ? std::string("nothing to ") + what : std::string(what) + ": " + name + " (" + key + ")";
    };
    step_button("\u21b6##undo", history.can_undo(), help("undo", history.undo_name(), "Ctrl+Z"), step, [&] { session.undo(); });
    note_rect("undo");
    ImGui::SameLine();
    step_button("\u21b7##redo", history.can_redo(), help("redo", history.redo_name(), "Ctrl+Y"), step, [&] { session.redo(); });
    note_rect("redo");
    if (!one_line && history.can_undo()) {
        ImGui::SameLine();
        ImGui::AlignTextToFramePadding();
        dim_text(cut_to("undo: " + history.undo_name(), ImGui::GetContentRegionAvail().x));
    }
    ImGui::PopStyleVar(2);
}

}  // namespace clarity::ui
