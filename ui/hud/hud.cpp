#include "ui/hud/hud.hpp"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "picture/film_noise.hpp"
#include "ui/session/session_output.hpp"
#include "ui/widgets/log_rows.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

constexpr ImGuiWindowFlags kCardFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                        ImGuiWindowFlags_NoFocusOnAppearing;

void begin_hud(const char* name, const ImVec2& position, const ImVec2& pivot, float width) {
    ImGui::SetNextWindowPos(position, ImGuiCond_Always, pivot);
    ImGui::SetNextWindowSize({width, 0});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, colors::kHudGround);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 8 * ui_scale());
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
    ImGui::Begin(name, nullptr, kCardFlags | ImGuiWindowFlags_AlwaysAutoResize);
}

void end_hud() {
    ImGui::End();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
}

// Draws text on the status line, then a gap.
void status_item(const std::string& text, const ImVec4& color, const std::string& help = {}) {
    if (ImGui::CalcTextSize(text.c_str()).x > ImGui::GetContentRegionAvail().x)
        return;  // omitted if it does not fit: earlier items matter more
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopStyleColor();
    tooltip(help);
    ImGui::SameLine(0, 22 * ui_scale());
}

constexpr double kNoticeSeconds = 6;

// The text about the last action: the window's own notice, or the last line of the log. Empty if it is too old.
std::string current_notice(Session& session, const UiState& state) {
    static uint64_t seen = 0;
    static double at_s = -1e9;
    const double now = ImGui::GetTime();
    if (state.notices != seen) {
        seen = state.notices;
        at_s = now;
    }
    if (now - at_s < kNoticeSeconds) return state.notice;
    const auto last = session.log_lines().last();
    const double clock_s = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    const bool tells = last && last->level == LogLevel::info && clock_s - last->at_s < kNoticeSeconds;
    return tells ? last->text.substr(0, last->text.find('\n')) : std::string();
}

}  // namespace

void draw_progress_hud(const Rect& viewport, Session& session) {
    // Short work shows no box, which would only flash.
    static double busy_since = -1;
    const Activity activity = session.activity();
    if (!activity.busy) {
        busy_since = -1;
        return;
    }
    if (busy_since < 0) busy_since = ImGui::GetTime();
    if (ImGui::GetTime() - busy_since < 0.15) return;
    // While a scene moves there is always work, but each pose takes a moment only.
    if (activity.only_pose && activity.seconds < 3) return;
    const float scale = ui_scale(), width = std::min(420 * scale, viewport.width - 32 * scale);
    begin_hud("Progress", {viewport.x + viewport.width / 2, viewport.y + viewport.height - 18 * scale}, {0.5f, 1}, width);
    const float cancel = 72 * scale;
    const float inner = ImGui::GetContentRegionAvail().x;
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(
        cut_front_to(activity.stage.empty() ? "working" : activity.stage, inner - cancel - 12 * scale).c_str());
    ImGui::SameLine(ImGui::GetCursorPosX() + inner - cancel);
    if (button("Cancel", "back to the settings of the picture (Esc)", cancel)) session.cancel();
    const ImVec2 bar(-FLT_MIN, 6 * scale);
    if (activity.fraction >= 0) {
        ImGui::ProgressBar(activity.fraction, bar, "");
    } else {  // unknown progress: a piece that moves to and fro
        const ImVec2 from = ImGui::GetCursorScreenPos();
        ImGui::ProgressBar(0, bar, "");
        const float piece = inner * 0.25f,
                    at = (inner - piece) * (0.5f - 0.5f * std::cos(static_cast<float>(ImGui::GetTime()) * 2.2f));
        ImGui::GetWindowDrawList()->AddRectFilled({from.x + at, from.y}, {from.x + at + piece, from.y + bar.y},
                                                  ImGui::GetColorU32(ImGuiCol_PlotHistogram), 3 * scale);
    }
    end_hud();
}

// Opens the Log tab at the first failure of a compiler or builder, since the log shows it with its place in the source.
void open_log_at_failure(const Session& session, UiState& state) {
    static bool failing = false;
    const WindowMessage& message = session.messages().shown();
    const bool source = !message.details.empty() || find_source_place(message.text) || message.failure == Failure::builder;
    if (!message.text.empty() && source && !failing) {
        state.show_tab(Tab::log);
        state.log_jump = true;
    }
    failing = !message.text.empty() && source;
}

void draw_message_hud(const Rect& viewport, Session& session, UiState& state) {
    open_log_at_failure(session, state);
    if (session.messages().shown().text.empty()) return;
    const float scale = ui_scale(), width = std::min(620 * scale, viewport.width - 32 * scale);
    begin_hud("Message", {viewport.x + viewport.width / 2, viewport.y + 18 * scale}, {0.5f, 0}, width);
    const ImVec2 corner = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.PushClipRectFullScreen();  // otherwise the padding would be clipped
    list.AddRectFilled(corner, {corner.x + 5 * scale, corner.y + size.y}, ImGui::GetColorU32(colors::kRed), 5 * scale,
                       ImDrawFlags_RoundCornersLeft);
    list.PopClipRect();
    ImGui::Indent(6 * scale);
    ImGui::PushTextWrapPos(0);
    const std::string& text = session.messages().shown().text;
    constexpr size_t kMost = 700;  // bytes; the log has the whole text
    ImGui::TextUnformatted(text.size() <= kMost ? text.c_str() : (text.substr(0, kMost) + "\u2026").c_str());
    ImGui::PopTextWrapPos();
    ImGui::Dummy({0, 2 * scale});
    const bool dismissed = button("Dismiss");
    ImGui::SameLine();
    if (button("Show log", "open the log, which has the whole message")) {
        state.show_tab(Tab::log);
        state.log_jump = true;
    }
    if (session.ready()) {
        ImGui::SameLine(0, 14 * scale);
        ImGui::AlignTextToFramePadding();
        dim_text("The last good picture goes on.");
    }
    ImGui::Unindent(6 * scale);
    end_hud();
    if (dismissed) session.messages().dismiss();
}

void draw_empty_hint(const Rect& viewport, const Session& session) {
    if (session.picture() || session.activity().busy || !session.messages().shown().text.empty()) return;
    const char* const lines[] = {"No scene yet", "Drop a file here, or press Open\u2026 at the right"};
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    float y = viewport.y + viewport.height / 2 - ImGui::GetTextLineHeightWithSpacing();
    for (const char* line : lines) {
        const ImVec2 size = ImGui::CalcTextSize(line);
        const ImVec4& color = line == lines[0] ? colors::kText : colors::kDim;
        list.AddText({std::floor(viewport.x + (viewport.width - size.x) / 2), y}, ImGui::GetColorU32(color), line);
        y += size.y * 1.6f;
    }
}

void draw_status_line(const Rect& area, Session& session, const VolumeOverlay& overlay, const UiState& state) {
    ImGui::SetNextWindowPos({area.x, area.y});
    ImGui::SetNextWindowSize({area.width, area.height});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, colors::kPanel);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(14 * ui_scale(), (area.height - ImGui::GetTextLineHeight()) / 2));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
    ImGui::Begin("Status", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse);
    const auto picture = session.picture();
    if (!picture) {
        status_item(session.activity().busy ? session.activity().stage : "ready", colors::kDim);
    } else {
        const Settings& s = picture->main.settings;
        char text[96];
        std::snprintf(text, sizeof text, "%.1f fps", frames_per_second(session));
        status_item(text, colors::kText, "frames a second, mean of the last ten");
        std::snprintf(text, sizeof text, "%.1f Mrays/s", mrays_per_second(session));
        status_item(text, colors::kText, "rays of all kinds, divided by the time of the kernels");
        std::snprintf(text, sizeof text, "%d\u00d7%d", s.width, s.height);
        status_item(
            text, colors::kDim,
            picture->reduced ? "pixels of the picture, fewer than asked for while something moves" : "pixels of the picture");
        std::snprintf(text, sizeof text, "sample %u/%d", std::max(1u, picture->main.stats.samples), s.spp);
        status_item(text, colors::kDim, "samples a pixel so far; more are added while the camera rests");
        if (adaptive_bound(s) > 0)
            status_item("adaptive, biased a little", colors::kAmber,
                        "pixels rest when their samples are alike: the setting `Adaptive`");
        if (denoises(s))
            status_item("denoised, biased", colors::kAmber,
                        "noise is filtered away, and with it some of what the picture shows: the setting `Denoise`");
        if (const uint64_t dropped = picture->main.stats.dropped; dropped > 0)
            status_item(
                count_text(static_cast<double>(dropped)) + " " + noun(dropped, "ray") + " dropped", colors::kAmber,
                "they found no slot in their pixel's arrays: raise `Ray slots` in the Render tab; or they met more than "
                "1024 surfaces that are cut out, one behind the other");
        if (const uint64_t broken = picture->main.stats.not_finite; broken > 0)
            status_item(count_text(static_cast<double>(broken)) + " " + noun(broken, "sample") + " not finite", colors::kAmber,
                        "they are no number, or infinite: the log says more");
        if (overlay.level()) {
            const std::string level =
                *overlay.level() == RT_LEVEL_BOTTOM ? "bottom level" : "level " + std::to_string(*overlay.level() + 1);
            const std::string more = overlay.count() >= VolumeOverlay::kLimit ? ", first " : ", ";
            status_item(level + more + plural(overlay.count(), "volume"), colors::kAmber);
        }
        const ReadySide& side = picture->job.ready->main;
        if (const std::string notice = current_notice(session, state); !notice.empty()) {
            status_item(cut_to(notice, ImGui::GetContentRegionAvail().x), colors::kGreen, notice);
        } else {
            status_item(side.accel->plugin->id, colors::kDim, side.accel->plugin->name);
            const std::string name = side.device_name();
            status_item(cut_to(name, ImGui::GetContentRegionAvail().x), colors::kDim, name);
        }
    }
    ImGui::End();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
}

}  // namespace clarity::ui
