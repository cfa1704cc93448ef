// The tabs of the log and of the plugins.
#include <imgui.h>

#include "ui/panel.hpp"
#include "ui/theme.hpp"
#include "ui/widgets.hpp"

namespace clarity {
namespace {

ImVec4 level_color(LogLevel level) {
    switch (level) {
        case LogLevel::debug:
            return colors::kDim;
        case LogLevel::info:
            return colors::kText;
        case LogLevel::warning:
            return colors::kAmber;
        case LogLevel::error:
            return colors::kRed;
    }
    return colors::kText;
}

std::string whole_log(const std::vector<LogLine>& lines) {
    std::string text;
    for (const LogLine& line : lines) text += line.text + "\n";
    return text;
}

void plugin_rows(const PluginRecord& record) {
    const rt_plugin* plugin = record.plugin;
    if (plugin) {
        ImGui::PushFont(fonts().bold);
        ImGui::TextUnformatted(plugin->id);
        ImGui::PopFont();
        ImGui::SameLine();
        dim_text(std::string(plugin->accel ? "acceleration structure" : "importer") + "  " + plugin->version);
        ImGui::TextWrapped("%s", plugin->name);
        if (plugin->reference) dim_text(plugin->reference);
        if (record.shadowed) {
            ImGui::PushStyleColor(ImGuiCol_Text, colors::kAmber);
            ImGui::TextWrapped("not used: an earlier library has the same id");
            ImGui::PopStyleColor();
        }
    } else {
        ImGui::PushStyleColor(ImGuiCol_Text, colors::kRed);
        ImGui::TextWrapped("refused: %s", record.why.c_str());
        ImGui::PopStyleColor();
    }
    dim_text(record.path);
    ImGui::Dummy({0, 6 * ui_scale()});
}

}  // namespace

void draw_log_tab(Session& session) {
    static bool details = false;
    ImGui::Dummy({0, 2 * ui_scale()});
    const std::vector<LogLine> lines = session.log_lines().lines();
    if (ImGui::Button("Copy")) ImGui::SetClipboardText(whole_log(lines).c_str());
    ImGui::SameLine();
    if (ImGui::Button("Clear")) session.log_lines().clear();
    ImGui::SameLine();
    ImGui::Checkbox("Debug lines", &details);
    ImGui::PushStyleColor(ImGuiCol_ChildBg, colors::kGround);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(8 * ui_scale(), 8 * ui_scale()));
    ImGui::BeginChild("lines", {0, 0}, false, ImGuiWindowFlags_AlwaysUseWindowPadding);
    ImGui::PushFont(fonts().mono);
    ImGui::PushTextWrapPos(0);
    for (const LogLine& line : lines) {
        if (line.level == LogLevel::debug && !details) continue;
        ImGui::PushStyleColor(ImGuiCol_Text, level_color(line.level));
        ImGui::TextUnformatted(line.text.c_str());
        ImGui::PopStyleColor();
    }
    ImGui::PopTextWrapPos();
    ImGui::PopFont();
    static uint64_t seen = 0;
    if (session.log_lines().revision() != seen) {
        seen = session.log_lines().revision();
        ImGui::SetScrollHereY(1.0f);
    }
    ImGui::EndChild();
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
}

void draw_plugins_tab(Session& session) {
    ImGui::Dummy({0, 4 * ui_scale()});
    if (session.plugins().records().empty()) dim_text("no plugin library was found");
    for (const PluginRecord& record : session.plugins().records()) plugin_rows(record);
}

}  // namespace clarity
