#include "ui/panel.hpp"

#include <imgui.h>

#include "ui/theme.hpp"

namespace clarity {

void draw_panel(const Rect& area, Session& session, VolumeOverlay& overlay, UiState& state, const std::string& gl_text) {
    ImGui::SetNextWindowPos({area.x, area.y});
    ImGui::SetNextWindowSize({area.width, area.height});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, colors::kPanel);
    ImGui::Begin("Panel", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav);
    if (ImGui::BeginTabBar("tabs", ImGuiTabBarFlags_FittingPolicyResizeDown | ImGuiTabBarFlags_NoTooltip)) {
        for (int i = 0; i < kTabCount; ++i) {
            const Tab tab = static_cast<Tab>(i);
            const bool bring = state.tab_asked && state.tab == tab;
            if (!ImGui::BeginTabItem(kTabNames[i], nullptr, bring ? ImGuiTabItemFlags_SetSelected : 0)) continue;
            if (!state.tab_asked) state.tab = tab;
            if (bring) state.tab_asked = false;
            ImGui::BeginChild("body", {0, 0}, false, tab == Tab::log ? ImGuiWindowFlags_NoScrollbar : 0);
            switch (tab) {
                case Tab::render:
                    draw_render_tab(session, overlay, state);
                    break;
                case Tab::scene:
                    draw_scene_tab(session, state);
                    break;
                case Tab::inspect:
                    break;
                case Tab::statistics:
                    draw_statistics_tab(session);
                    break;
                case Tab::log:
                    draw_log_tab(session);
                    break;
                case Tab::plugins:
                    draw_plugins_tab(session);
                    break;
                case Tab::help:
                    draw_help_tab(state, gl_text);
                    break;
            }
            ImGui::EndChild();
            ImGui::EndTabItem();
        }
        ImGui::EndTabBar();
    }
    ImGui::End();
    ImGui::PopStyleColor();
}

}  // namespace clarity
