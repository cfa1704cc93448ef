// The Log tab. Rows are laid out once, and only the visible ones are drawn.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "ui/panel/panel.hpp"
#include "ui/widgets/imgui_calls.hpp"
#include "ui/widgets/log_rows.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

const ImVec4& level_color(LogLevel level) {
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

struct View {
    LogFilter filter;
    std::vector<LogRow> rows;
    std::vector<float> tops;  // of the rows; the last entry is the end
    uint64_t revision = 0;
    float width = 0, scale = 0;
    LogFilter of;
    bool laid_out = false;
};
View view;

float indent_of(const LogRow& row) {
    return (row.inside ? 14.0f : 0.0f) * ui_scale();
}

// Lays out the rows. Returns whether new lines came.
bool lay_out(Session& session, float width) {
    const uint64_t revision = session.log_lines().revision();
    const bool same_filter = view.of.least == view.filter.least && view.of.words == view.filter.words;
    if (view.laid_out && revision == view.revision && width == view.width && ui_scale() == view.scale && same_filter)
        return false;
    view.rows = log_rows(session.log_lines().lines(), view.filter);
    const bool news = revision != view.revision;
    view.revision = revision;
    view.width = width;
    view.scale = ui_scale();
    view.of = view.filter;
    view.laid_out = true;
    view.tops.assign(1, 0);
    for (const LogRow& row : view.rows) {
        const float gap = (row.first ? 4.0f : 0.0f) * ui_scale();
        const float height =
            row.place ? ImGui::GetTextLineHeight()
                      : ImGui::CalcTextSize(row.text.c_str(), nullptr, false, std::max(width - indent_of(row), 20.0f)).y;
        view.tops.push_back(view.tops.back() + gap + std::max(height, ImGui::GetTextLineHeight()));
    }
    return news;
}

void place_row(const LogRow& row, const ImVec2& at, UiState& state) {
    const std::string shown = cut_front_to(row.text, view.width);
    ImGui::SetCursorScreenPos(at);
    const ImVec2 size = ImGui::CalcTextSize(shown.c_str());
    if (ImGui::InvisibleButton("place", size)) {
        ImGui::SetClipboardText(row.text.c_str());
        state.notify("copied " + row.text);
    }
    note_rect(row.text);
    const ImU32 color = ImGui::GetColorU32(ImGui::IsItemHovered() ? colors::kText : colors::kAccent);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddText(at, color, shown.c_str());
    list.AddLine({at.x, at.y + size.y}, {at.x + size.x, at.y + size.y}, color);
    tooltip(row.text + "\nclick to copy");
}

void draw_rows(UiState& state) {
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const float top = ImGui::GetScrollY(), bottom = top + ImGui::GetWindowHeight();
    auto first = std::upper_bound(view.tops.begin(), view.tops.end(), top) - view.tops.begin();
    for (size_t i = static_cast<size_t>(std::max<std::ptrdiff_t>(first - 1, 0)); i < view.rows.size(); ++i) {
        if (view.tops[i] > bottom) break;
        const LogRow& row = view.rows[i];
        const float gap = (row.first ? 4.0f : 0.0f) * ui_scale();
        const ImVec2 at(from.x + indent_of(row), from.y + view.tops[i] + gap);
        ImGui::PushID(static_cast<int>(i));
        if (row.place)
            place_row(row, at, state);
        else
            ImGui::GetWindowDrawList()->AddText(ImGui::GetFont(), ImGui::GetFontSize(), at,
                                                ImGui::GetColorU32(level_color(row.level)), row.text.c_str(), nullptr,
                                                std::max(view.width - indent_of(row), 20.0f));
        ImGui::PopID();
    }
    ImGui::SetCursorScreenPos(from);
    ImGui::Dummy({view.width, view.tops.back()});
}

float last_error_top() {
    size_t at = 0;
    for (size_t i = 0; i < view.rows.size(); ++i)
        if (view.rows[i].first && view.rows[i].level == LogLevel::error) at = i;
    return view.tops[at];
}

std::string shown_text() {
    std::string text;
    for (const LogRow& row : view.rows) text += (row.inside ? "    " : "") + row.text + "\n";
    return text;
}

void head(Session& session, UiState& state) {
    static const std::pair<const char*, LogLevel> levels[] = {{"All lines", LogLevel::debug},
                                                              {"No details", LogLevel::info},
                                                              {"Warnings and errors", LogLevel::warning},
                                                              {"Errors", LogLevel::error}};
    const float third = share_of_line(3);
    ImGui::SetNextItemWidth(third);
    const char* name = "";
    for (const auto& [text, level] : levels)
        if (level == view.filter.least) name = text;
    if (ImGui::BeginCombo("##level", name)) {
        for (const auto& [text, level] : levels)
            if (option(text, level == view.filter.least)) view.filter.least = level;
        ImGui::EndCombo();
    }
    note_rect("log level");
    ImGui::SameLine();
    if (button("Copy", "the lines that are shown, to the clipboard", third)) {
        ImGui::SetClipboardText(shown_text().c_str());
        state.notify(plural(view.rows.size(), "line") + " copied");
    }
    ImGui::SameLine();
    if (button("Clear", {}, third)) session.log_lines().clear();
    ImGui::SetNextItemWidth(-FLT_MIN);
    ImGui::InputTextWithHint("##words", "find", &view.filter.words);
    note_rect("find in the log");
}

}  // namespace

void draw_log_tab(Session& session, UiState& state) {
    ImGui::Dummy({0, 2 * ui_scale()});
    head(session, state);
    ImGui::PushStyleColor(ImGuiCol_ChildBg, colors::kGround);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(8 * ui_scale(), 8 * ui_scale()));
    begin_padded_child("lines", {0, 0}, ImGuiWindowFlags_AlwaysVerticalScrollbar);
    ImGui::PushFont(fonts().mono);
    // At the end of the log, the view follows new lines. Further up, it stays where it is.
    const bool at_end = ImGui::GetScrollY() >= ImGui::GetScrollMaxY() - 1;
    const bool news = lay_out(session, ImGui::GetContentRegionAvail().x);
    if (view.rows.empty()) dim_text(view.filter.words.empty() ? "nothing yet" : "no line has these words");
    draw_rows(state);
    if (state.log_jump) {
        ImGui::SetScrollY(last_error_top());
        state.log_jump = false;
    } else if (news && at_end) {
        ImGui::SetScrollHereY(1.0f);
    }
    ImGui::PopFont();
    ImGui::EndChild();
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
}

}  // namespace clarity::ui
