#include "ui/hud/keys_hud.hpp"

#include <imgui.h>

#include <algorithm>

#include "ui/widgets/key_map.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

// The keys of a map for the bindings with this help text: held actions of one kind share theirs ("move the camera in X
// and Z").
std::string keys_for(const KeyMap& map, const std::string& help) {
    std::vector<std::string> names;
    for (const KeyBinding& binding : map.bindings)
        if (binding.help == help) names.push_back(name_on_cap(binding.key, binding.name));
    if (names.size() > 4) return names.front() + " \u2013 " + names.back();
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
    return text;
}

void mouse_line(const char* button, const char* thesis, const char* viewer) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kAccent);
    ImGui::TextUnformatted(button);
    ImGui::PopStyleColor();
    ImGui::TableNextColumn();
    wrapped_text(thesis);
    ImGui::TableNextColumn();
    wrapped_text(viewer);
}

}  // namespace

std::vector<KeyLine> key_lines() {
    std::vector<KeyLine> lines;
    for (const KeyMap& map : key_maps())
        for (const KeyBinding& binding : map.bindings) {
            const bool known =
                std::any_of(lines.begin(), lines.end(), [&](const KeyLine& line) { return line.help == binding.help; });
            if (known) continue;
            KeyLine line;
            line.help = binding.help;
            for (const KeyMap& each : key_maps()) line.keys.push_back(keys_for(each, binding.help));
            lines.push_back(line);
        }
    // Lines with different keys in different maps come first: these are the motions.
    std::stable_partition(lines.begin(), lines.end(), [](const KeyLine& line) {
        return std::any_of(line.keys.begin(), line.keys.end(),
                           [&](const std::string& keys) { return keys != line.keys.front(); });
    });
    return lines;
}

void draw_key_table(const UiState& state) {
    const int maps = static_cast<int>(key_maps().size());
    if (!ImGui::BeginTable("keys", maps + 1, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) return;
    for (const KeyMap& map : key_maps()) ImGui::TableSetupColumn(map.name);
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableNextRow();
    for (const KeyMap& map : key_maps()) {
        ImGui::TableNextColumn();
        ImGui::PushFont(fonts().bold);
        const bool used = &map == state.key_map;
        ImGui::PushStyleColor(ImGuiCol_Text, used ? colors::kText : colors::kDim);
        ImGui::TextUnformatted(map.name);
        ImGui::PopStyleColor();
        ImGui::PopFont();
    }
    for (const KeyLine& line : key_lines()) {
        ImGui::TableNextRow();
        for (size_t i = 0; i < line.keys.size(); ++i) {
            ImGui::TableNextColumn();
            const bool used = &key_maps()[i] == state.key_map;
            ImGui::PushStyleColor(ImGuiCol_Text, used ? colors::kAccent : colors::kDim);
            ImGui::TextUnformatted(line.keys[i].c_str());
            ImGui::PopStyleColor();
        }
        ImGui::TableNextColumn();
        wrapped_text(line.help);
    }
    ImGui::EndTable();
    if (!ImGui::BeginTable("mouse", 3, ImGuiTableFlags_RowBg)) return;
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableNextRow();
    const char* const titles[] = {"Mouse", "Thesis", "Viewer"};
    for (const char* title : titles) {
        ImGui::TableNextColumn();
        ImGui::PushFont(fonts().bold);
        ImGui::TextUnformatted(title);
        ImGui::PopFont();
    }
    mouse_line("Left drag", "orbit about the target", "look around");
    mouse_line("Ctrl + left drag", "trace that part of the picture alone; V: all of it", "the same");
    mouse_line("Middle, right drag", "shift the view", "shift the view");
    mouse_line("Wheel", "nearer, farther", "nearer, farther");
    mouse_line("Click", "select, and inspect the pixel", "the same");
    mouse_line("Double click", "look at that point", "the same");
    ImGui::EndTable();
}

void draw_keys_hud(const Rect& area, UiState& state) {
    if (!state.keys_open) return;
    const float scale = ui_scale();
    const float width = std::min(640 * scale, area.width - 24 * scale),
                height = std::min(740 * scale, area.height - 24 * scale);
    ImGui::SetNextWindowPos({area.x + area.width / 2, area.y + area.height / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({width, height});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, colors::kHudGround);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 8 * scale);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
    ImGui::Begin("Keys", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
    const bool outside = ImGui::IsMouseClicked(0) && !ImGui::IsWindowHovered(ImGuiHoveredFlags_RootAndChildWindows);
    ImGui::PushFont(fonts().bold);
    ImGui::TextUnformatted("Keys");
    ImGui::PopFont();
    ImGui::SameLine();
    dim_text("F1 or Esc closes this; the map is chosen in the Help tab");
    draw_key_table(state);
    if (button("Close the list of keys", {}, -FLT_MIN) || (outside && !ImGui::IsWindowAppearing())) state.keys_open = false;
    ImGui::End();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
}

}  // namespace clarity::ui
