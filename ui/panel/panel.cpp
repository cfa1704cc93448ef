#include "ui/panel/panel.hpp"

#include <imgui.h>
#include <algorithm>
#include <cmath>

#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

constexpr float kNarrowest = 320, kGrip = 5;  // at text scale 1

// Draws the panel's left edge, which can be dragged.
void draw_edge(const Rect& area, UiState& state) {
    const float scale = ui_scale();
    ImGui::SetCursorScreenPos({area.x, area.y});
    ImGui::InvisibleButton("edge", {kGrip * scale, std::max(area.height, 1.0f)});
    const bool held = ImGui::IsItemActive();
    if (held || ImGui::IsItemHovered()) {
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
        ImGui::GetWindowDrawList()->AddRectFilled({area.x, area.y}, {area.x + 2 * scale, area.y + area.height},
                                                  ImGui::GetColorU32(colors::kAccent));
    }
    if (held) state.panel_width = std::max(kNarrowest, (area.x + area.width - ImGui::GetIO().MousePos.x) / scale);
}

// Draws the tabs on one line, or on two if they do not fit.
void draw_tabs(UiState& state) {
    const float room = ImGui::GetContentRegionAvail().x, scale = ui_scale();
    float widths[kTabCount], words = 0;
    for (int i = 0; i < kTabCount; ++i) words += widths[i] = ImGui::CalcTextSize(kTabNames[i]).x;
    const float least = 5 * scale;
    const int lines = words + 2 * least * kTabCount <= room ? 1 : 2, per_line = (kTabCount + lines - 1) / lines;
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const float height = std::round(ImGui::GetFrameHeight() + 2 * scale);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (int line = 0; line < lines; ++line) {
        const int first = line * per_line, last = std::min(first + per_line, kTabCount);
        float sum = 0;
        for (int i = first; i < last; ++i) sum += widths[i];
        const float pad = (room - sum) / static_cast<float>(2 * (last - first));
        ImVec2 at(from.x, from.y + static_cast<float>(line) * height);
        for (int i = first; i < last; ++i) {
            const float width = widths[i] + 2 * pad;
            const Tab tab = static_cast<Tab>(i);
            ImGui::SetCursorScreenPos(at);
            if (ImGui::InvisibleButton(kTabNames[i], {width, height})) state.tab = tab;
            note_rect(std::string("tab ") + kTabNames[i]);
            const bool chosen = state.tab == tab, hovered = ImGui::IsItemHovered();
            if (chosen || hovered)
                list.AddRectFilled(at, {at.x + width, at.y + height},
                                   ImGui::GetColorU32(chosen ? ImGuiCol_TabActive : ImGuiCol_TabHovered), 4 * scale,
                                   ImDrawFlags_RoundCornersTop);
            const float text_y = at.y + (height - ImGui::GetTextLineHeight()) / 2;
            list.AddText({std::round(at.x + pad), std::round(text_y)},
                         ImGui::GetColorU32(chosen ? colors::kText : colors::kDim), kTabNames[i]);
            at.x += width;
        }
    }
    const float bottom = from.y + static_cast<float>(lines) * height;
    list.AddLine({from.x, bottom}, {from.x + room, bottom}, ImGui::GetColorU32(ImGuiCol_TabActive));
    ImGui::SetCursorScreenPos({from.x, bottom + ImGui::GetStyle().ItemSpacing.y / 2});
    state.tab_asked = false;
}

void draw_body(Session& session, VolumeOverlay& overlay, UiState& state, const std::string& gl_text) {
    switch (state.tab) {
        case Tab::render:
            return draw_render_tab(session, overlay, state);
        case Tab::scene:
            return draw_scene_tab(session, state);
        case Tab::inspect:
            return draw_inspect_tab(session, state);
        case Tab::statistics:
            return draw_statistics_tab(session);
        case Tab::log:
            return draw_log_tab(session, state);
        case Tab::plugins:
            return draw_plugins_tab(session);
        case Tab::help:
            return draw_help_tab(state, gl_text);
    }
}

bool word_row(const Key& key, const char* id, float& value) {
    bool changed = false;
    if (!ImGui::BeginCombo(id, key.words[static_cast<size_t>(value)])) return false;
    for (size_t i = 0; key.words[i]; ++i) {
        const auto number = static_cast<float>(i);
        if (!option(key.words[i], value == number)) continue;
        changed |= value != number;
        value = number;
    }
    ImGui::EndCombo();
    return changed;
}

bool flag_row(const char* id, float& value) {
    bool on = value != 0;
    if (!ImGui::Checkbox(id, &on)) return false;
    value = on ? 1.0f : 0.0f;
    return true;
}

bool number_row(const Key& key, const char* id, float& value, float size) {
    if (key.step > 0) return ImGui::DragFloat(id, &value, key.step, 0, 0, "%.6g");
    if (key.max >= kMostNumber) return ImGui::DragFloat(id, &value, size * 0.002f, 0, 0, "%.3g");
    return slider(id, value, static_cast<float>(key.min), static_cast<float>(key.max), "%.3f", key.logarithmic);
}

}  // namespace

void draw_panel(const Rect& area, Session& session, VolumeOverlay& overlay, UiState& state, const std::string& gl_text) {
    ImGui::SetNextWindowPos({area.x, area.y});
    ImGui::SetNextWindowSize({area.width, area.height});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, colors::kPanel);
    ImGui::Begin("Panel", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav);
    const ImVec2 start = ImGui::GetCursorScreenPos();
    draw_edge(area, state);
    ImGui::SetCursorScreenPos(start);
    draw_toolbar(session, overlay, state);
    draw_tabs(state);
    // Each tab keeps its own scroll position.
    ImGui::BeginChild(kTabNames[static_cast<int>(state.tab)], {0, 0}, false,
                      state.tab == Tab::log ? ImGuiWindowFlags_NoScrollbar : 0);
    draw_body(session, overlay, state, gl_text);
    ImGui::EndChild();
    ImGui::End();
    ImGui::PopStyleColor();
}

bool key_row(const Key& key, std::array<float, 3>& value, float size) {
    const std::string id = std::string("##") + key.name;
    const std::string help = *key.more ? std::string(key.help) + ": " + key.more : key.help;
    row_label(key.label, help);
    const float step = key.moves == Moves::point || key.moves == Moves::vector ? size * 0.002f : 0.005f;
    bool changed = false;
    if (key.kind == RT_KEY_WORD)
        changed = word_row(key, id.c_str(), value[0]);
    else if (key.kind == RT_KEY_FLAG)
        changed = flag_row(id.c_str(), value[0]);
    else if (key.kind == RT_KEY_COLOR)
        changed = color_field(id.c_str(), value.data());
    else if (count_of(key) == 3)
        changed = ImGui::DragFloat3(id.c_str(), value.data(), step, 0, 0, "%.3g");
    else
        changed = number_row(key, id.c_str(), value[0], size);
    if (changed) value = nearest_value(key, value);
    return changed;
}

}  // namespace clarity::ui
