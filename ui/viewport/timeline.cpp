#include "ui/viewport/timeline.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "ui/widgets/imgui_calls.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

// Lengths at scale 1.
constexpr float kMargin = 12, kLoopHeight = 9, kTrackHeight = 26, kGap = 6, kHandleWidth = 9;
constexpr float kButtonWidth = 34, kSpeedWidth = 84, kClipWidth = 200, kLeastClipWidth = 110, kTextWidth = 165;
constexpr float kSpeeds[] = {0.1f, 0.25f, 0.5f, 1, 2, 4};

float controls_width() {
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    return (4 * kButtonWidth + kSpeedWidth + kLeastClipWidth + kTextWidth) * ui_scale() + 6 * gap;
}

bool narrow(float width) {
    return width - 2 * kMargin * ui_scale() < controls_width();
}

ImU32 color(const ImVec4& c, float opacity = 1) {
    return ImGui::GetColorU32(ImVec4(c.x, c.y, c.z, opacity));
}

TimelineScale scale_of(const Session& session, float left, float right) {
    const ClipInfo& clip = session.playback().clip(session.desired);
    const double end = clip.end_s > clip.begin_s ? clip.end_s : clip.begin_s + 1 / session.playback().fps(session.desired);
    return {clip.begin_s, end, left, right};
}

double nearest_frame_s(double time_s, double fps) {
    return time_of_frame(static_cast<double>(frame_at(time_s, fps)), fps);
}

// ---- the bar with the loop

void drag_loop_end(const char* label, const char* help, bool end, const TimelineScale& scale, const Rect& bar,
                   Session& session) {
    const auto loop = session.desired.loop;
    const float width = kHandleWidth * ui_scale(), at = scale.place_of(loop[end]);
    // The handles lie beside each other, outside of the loop, so that both can be gripped in the shortest one.
    const float left = end ? at : at - width;
    ImGui::SetCursorScreenPos({left, bar.y});
    ImGui::InvisibleButton(label, {width, bar.height});
    note_rect(label);
    tooltip(help);
    const bool held = ImGui::IsItemActive(), lit = held || ImGui::IsItemHovered();
    if (lit) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (held) {
        const float mouse = ImGui::GetIO().MousePos.x + (end ? -width / 2 : width / 2);
        const double time = nearest_frame_s(scale.time_at(mouse), session.playback().fps(session.desired));
        // The end that is held stops at the other one.
        const double frame = 1 / session.playback().fps(session.desired);
        if (end)
            session.playback().set_loop(session.desired, loop[0], time);
        else
            session.playback().set_loop(session.desired, std::min(time, loop[1] - frame), loop[1]);
    }
    ImGui::GetWindowDrawList()->AddRectFilled({left, bar.y}, {left + width, bar.y + bar.height},
                                              color(lit ? colors::kText : colors::kAccent), 2 * ui_scale(),
                                              end ? ImDrawFlags_RoundCornersRight : ImDrawFlags_RoundCornersLeft);
}

void draw_loop(const Rect& bar, const TimelineScale& scale, Session& session) {
    ImGui::SetCursorScreenPos({bar.x, bar.y});
    covered_button("##loop", {bar.width, bar.height});
    const ClipInfo& clip = session.playback().clip(session.desired);
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0))
        session.playback().set_loop(session.desired, clip.begin_s, clip.end_s);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled({bar.x, bar.y}, {bar.x + bar.width, bar.y + bar.height}, ImGui::GetColorU32(ImGuiCol_FrameBg),
                       2 * ui_scale());
    const auto loop = session.desired.loop;
    list.AddRectFilled({scale.place_of(loop[0]), bar.y}, {scale.place_of(loop[1]), bar.y + bar.height},
                       color(colors::kAccent, 0.35f));
    drag_loop_end("loop begin", "drag: where the loop begins; double click on the bar: the whole clip", false, scale, bar,
                  session);
    drag_loop_end("loop end", "drag: where the loop ends; double click on the bar: the whole clip", true, scale, bar, session);
}

// ---- the track with frames and the time

void draw_marks(ImDrawList& list, const Rect& track, const TimelineScale& scale, double fps) {
    const float ui = ui_scale(), low = track.y + track.height;
    const long fine = mark_step(scale, fps, 6 * ui);
    for (const long frame : marked_frames(scale, fps, fine)) {
        const float x = std::floor(scale.place_of(time_of_frame(double(frame), fps))) + 0.5f;
        list.AddLine({x, low - 4 * ui}, {x, low}, color(colors::kDim, 0.45f));
    }
    ImFont* const font = fonts().text ? fonts().text : ImGui::GetFont();
    const float size = std::round(ImGui::GetFontSize() * 0.8f);
    const std::string widest = std::to_string(frame_at(scale.end_s, fps));
    const float room = font->CalcTextSizeA(size, FLT_MAX, 0, widest.c_str()).x + 18 * ui;
    for (const long frame : marked_frames(scale, fps, mark_step(scale, fps, room))) {
        const float x = std::floor(scale.place_of(time_of_frame(double(frame), fps))) + 0.5f;
        list.AddLine({x, low - 7 * ui}, {x, low}, color(colors::kDim));
        const std::string text = std::to_string(frame);
        const float width = font->CalcTextSizeA(size, FLT_MAX, 0, text.c_str()).x;
        const float left = std::clamp(x - width / 2, track.x, std::max(track.x, track.x + track.width - width));
        list.AddText(font, size, {std::floor(left), std::floor(track.y + 6 * ui)}, color(colors::kDim), text.c_str());
    }
}

// A key of the camera's path.
void draw_key(ImDrawList& list, const ImVec2& at, float size, ImU32 tint, bool filled) {
    const ImVec2 corners[4] = {{at.x, at.y - size}, {at.x + size, at.y}, {at.x, at.y + size}, {at.x - size, at.y}};
    if (filled)
        list.AddConvexPolyFilled(corners, 4, tint);
    else
        list.AddPolyline(corners, 4, tint, ImDrawFlags_Closed, 1.6f * ui_scale());
}

void draw_keys(ImDrawList& list, const Rect& track, const TimelineScale& scale, const Session& session) {
    for (const CameraKey& key : session.desired.camera_path.keys)
        if (key.time_s >= scale.begin_s && key.time_s <= scale.end_s)
            draw_key(list, {std::floor(scale.place_of(key.time_s)) + 0.5f, track.y + track.height - 8 * ui_scale()},
                     5 * ui_scale(), color(colors::kAmber), true);
}

// The time that is asked for, and the one that the picture shows while it is behind.
void draw_times(ImDrawList& list, const Rect& track, const TimelineScale& scale, const Session& session) {
    const float ui = ui_scale(), low = track.y + track.height;
    const auto& time = session.desired.pose.time_s;
    const auto picture = session.picture();
    if (picture) {
        const PoseTime& shown = picture->job.ready->request.pose;
        if (shown.time_s && shown.time_s != time && shown.clip == session.desired.pose.clip) {
            const float x = std::floor(scale.place_of(*shown.time_s)) + 0.5f;
            list.AddLine({x, track.y}, {x, low}, color(colors::kAmber, 0.6f), ui);
        }
    }
    if (!time) return;
    const float x = std::floor(scale.place_of(*time)) + 0.5f;
    list.AddLine({x, track.y}, {x, low}, color(colors::kText), 1.6f * ui);
    list.AddTriangleFilled({x - 5 * ui, track.y}, {x + 5 * ui, track.y}, {x, track.y + 6 * ui}, color(colors::kText));
}

void draw_track(const Rect& track, const TimelineScale& scale, Session& session) {
    Playback& playback = session.playback();
    ImGui::SetCursorScreenPos({track.x, track.y});
    ImGui::InvisibleButton("##track", {track.width, track.height});
    note_rect("track", track);
    const bool held = ImGui::IsItemActive();
    if (held) playback.show(session.desired, scale.time_at(ImGui::GetIO().MousePos.x));
    playback.hold(held);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled({track.x, track.y}, {track.x + track.width, track.y + track.height},
                       ImGui::GetColorU32(ImGuiCol_FrameBg), 3 * ui_scale());
    const auto loop = session.desired.loop;
    list.AddRectFilled({scale.place_of(loop[0]), track.y}, {scale.place_of(loop[1]), track.y + track.height},
                       color(colors::kAccent, 0.1f));
    draw_marks(list, track, scale, playback.fps(session.desired));
    draw_times(list, track, scale, session);
    draw_keys(list, track, scale, session);
}

// ---- the row of buttons

enum class Icon { play, pause, back, forward, key, no_key };

void draw_icon(Icon icon) {
    const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
    const float x = (from.x + to.x) / 2, y = (from.y + to.y) / 2, r = std::round(5.5f * ui_scale());
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 text = color(colors::kText);
    const auto bar = [&](float left) { list.AddRectFilled({left, y - r}, {left + std::round(0.55f * r), y + r}, text); };
    switch (icon) {
        case Icon::play:
            list.AddTriangleFilled({x - 0.7f * r, y - r}, {x - 0.7f * r, y + r}, {x + 1.1f * r, y}, text);
            break;
        case Icon::pause:
            bar(x - 0.8f * r);
            bar(x + 0.3f * r);
            break;
        case Icon::forward:
            list.AddTriangleFilled({x - r, y - r}, {x - r, y + r}, {x + 0.5f * r, y}, text);
            bar(x + 0.6f * r);
            break;
        case Icon::key:
        case Icon::no_key:
            draw_key(list, {x, y}, 1.1f * r, icon == Icon::key ? color(colors::kAmber) : text, icon == Icon::key);
            break;
        case Icon::back:
            list.AddTriangleFilled({x + r, y - r}, {x - 0.5f * r, y}, {x + r, y + r}, text);
            bar(x - 1.1f * r);
            break;
    }
}

bool icon_button(const char* label, Icon icon, const char* help) {
    const bool pressed = ImGui::Button((std::string("##") + label).c_str(), {kButtonWidth * ui_scale(), 0});
    note_rect(label);
    tooltip(help);
    draw_icon(icon);
    return pressed;
}

// Sets a key of the camera's path, or takes it away where the camera stands on it.
void draw_key_button(Session& session) {
    const CameraPath& path = session.desired.camera_path;
    const auto& time = session.desired.pose.time_s;
    const int at = time ? path.key_at(*time) : -1;
    const bool stands_on_it = at >= 0 && path.keys[static_cast<size_t>(at)] ==
                                             CameraKey{path.keys[static_cast<size_t>(at)].time_s, session.desired.camera};
    const char* help = stands_on_it ? "take the camera's key away from this time"
                       : at >= 0
                           ? "the camera's key at this time: as the camera stands now"
                           : "set a key of the camera's path here: move to another time, move the camera, set the next one; "
                             "the camera goes from key to key as the clip plays";
    if (!icon_button("camera key", at >= 0 ? Icon::key : Icon::no_key, help)) return;
    stands_on_it ? session.playback().remove_camera_key(session.desired) : session.playback().set_camera_key(session.desired);
}

void draw_buttons(Session& session) {
    Playback& playback = session.playback();
    if (icon_button("step back", Icon::back, "the frame before (,)")) playback.step(session.desired, -1);
    ImGui::SameLine();
    const bool playing = playback.playing();
    if (icon_button("play", playing ? Icon::pause : Icon::play, playing ? "pause (Space)" : "play (Space)"))
        session.playback().toggle(session.desired);
    ImGui::SameLine();
    if (icon_button("step forward", Icon::forward, "the frame after (.)")) playback.step(session.desired, 1);
    ImGui::SameLine();
    draw_key_button(session);
}

std::string speed_text(float speed) {
    char text[32];
    std::snprintf(text, sizeof text, "%g\u00d7", double(speed));
    return text;
}

void draw_speed(Session& session) {
    ImGui::SetNextItemWidth(kSpeedWidth * ui_scale());
    const bool open = ImGui::BeginCombo("##speed", speed_text(session.desired.speed).c_str());
    note_rect("speed of the clip");
    if (!open) return tooltip("how fast the clip's clock goes");
    for (const float speed : kSpeeds)
        if (option(speed_text(speed), speed == session.desired.speed)) session.desired.speed = speed;
    ImGui::EndCombo();
}

std::string clip_name(const ClipInfo& clip) {
    return clip.name.empty() ? "clip" : clip.name;
}

void draw_clips(Session& session, float width) {
    Playback& playback = session.playback();
    const PoseTime& pose = session.desired.pose;
    const std::string chosen = pose.time_s ? clip_name(playback.clip(session.desired)) : "At rest";
    ImGui::SetNextItemWidth(width);
    const bool open = ImGui::BeginCombo("##clip", cut_to(chosen, width - ImGui::GetFrameHeight() - 8 * ui_scale()).c_str(),
                                        ImGuiComboFlags_HeightLarge);
    note_rect("clip");
    if (!open) return tooltip(chosen + ": the clip of the file that moves the scene");
    if (option("At rest", !pose.time_s)) playback.rest(session.desired);
    for (size_t i = 0; i < playback.clips().size(); ++i) {
        const ClipInfo& clip = playback.clips()[i];
        ImGui::PushID(static_cast<int>(i));
        if (option(clip_name(clip), pose.time_s && clip.name == pose.clip)) playback.choose(session.desired, clip.name);
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

// The time, as much of it as fits into the rest of the line.
void draw_time_text(const Session& session, float right) {
    const auto& time = session.desired.pose.time_s;
    const double fps = session.playback().fps(session.desired);
    char seconds[48] = "at rest", whole[96] = "at rest";
    if (time) {
        const double frame = *time * fps;
        const bool between = !session.playback().playing() && std::fabs(frame - std::round(frame)) > 1e-3;
        std::snprintf(seconds, sizeof seconds, "%.3f s", *time);
        std::snprintf(whole, sizeof whole, between ? "%s   frame %.1f" : "%s   frame %.0f", seconds,
                      between ? frame : std::round(frame));
    }
    const float room = right - ImGui::GetCursorScreenPos().x;
    for (const char* text : {whole, seconds}) {
        const float width = ImGui::CalcTextSize(text).x;
        if (width > room) continue;
        ImGui::SetCursorScreenPos({std::floor(right - width), ImGui::GetCursorScreenPos().y});
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted(text);
        char help[96];
        std::snprintf(help, sizeof help, "on the clip's own clock; %g frames a second", fps);
        tooltip(help);
        return;
    }
}

void draw_controls(const Rect& area, float y, Session& session) {
    const float gap = ImGui::GetStyle().ItemSpacing.x, margin = kMargin * ui_scale();
    const float left = area.x + margin, right = area.x + area.width - margin;
    ImGui::SetCursorScreenPos({left, y});
    draw_buttons(session);
    if (narrow(area.width)) {
        ImGui::SameLine();
        draw_time_text(session, right);
        ImGui::SetCursorScreenPos({left, y + ImGui::GetFrameHeightWithSpacing()});
        const float speed = kSpeedWidth * ui_scale();
        draw_clips(session, std::max(40.0f, right - left - speed - gap));
        ImGui::SameLine();
        draw_speed(session);
        return;
    }
    ImGui::SameLine();
    draw_speed(session);
    ImGui::SameLine();
    const float room = right - ImGui::GetCursorScreenPos().x - kTextWidth * ui_scale() - gap;
    draw_clips(session, std::min(room, kClipWidth * ui_scale()));
    ImGui::SameLine();
    draw_time_text(session, right);
}

}  // namespace

float timeline_height(const Session& session, float width) {
    if (!session.playback().any()) return 0;
    const float rows = narrow(width) ? ImGui::GetFrameHeightWithSpacing() + ImGui::GetFrameHeight() : ImGui::GetFrameHeight();
    return std::round((kLoopHeight + kTrackHeight + 3 * kGap) * ui_scale() + rows);
}

void draw_timeline(const Rect& area, Session& session) {
    if (!session.playback().any()) return;
    ImGui::SetNextWindowPos({area.x, area.y});
    ImGui::SetNextWindowSize({area.width, area.height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
    ImGui::Begin("Timeline", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav |
                     ImGuiWindowFlags_NoScrollWithMouse);
    ImGui::PopStyleVar(2);
    const float ui = ui_scale(), margin = kMargin * ui;
    const Rect bar{area.x + margin, area.y, std::max(area.width - 2 * margin, 1.0f), std::round(kLoopHeight * ui)};
    const Rect track{bar.x, bar.y + bar.height + 1, bar.width, std::round(kTrackHeight * ui)};
    const TimelineScale scale = scale_of(session, track.x + kHandleWidth * ui, track.x + track.width - kHandleWidth * ui);
    draw_loop(bar, scale, session);
    draw_track(track, scale, session);
    draw_controls(area, track.y + track.height + std::round(kGap * ui), session);
    ImGui::End();
}

float TimelineScale::place_of(double time_s) const {
    const double length = end_s - begin_s;
    const double share = length > 0 ? std::clamp((time_s - begin_s) / length, 0.0, 1.0) : 0.0;
    return left + static_cast<float>(share) * (right - left);
}

double TimelineScale::time_at(float place) const {
    const float width = right - left;
    const double share = width > 0 ? std::clamp(double(place - left) / double(width), 0.0, 1.0) : 0.0;
    return begin_s + share * (end_s - begin_s);
}

long mark_step(const TimelineScale& scale, double fps, float least) {
    const double frames = (scale.end_s - scale.begin_s) * fps;
    const double needed = frames * double(least) / std::max(double(scale.right - scale.left), 1.0);
    for (double ten = 1; ten < 1e9; ten *= 10)
        for (const double digit : {1.0, 2.0, 5.0})
            if (ten * digit >= needed) return static_cast<long>(ten * digit);
    return 1000000000;
}

std::vector<long> marked_frames(const TimelineScale& scale, double fps, long step) {
    std::vector<long> frames;
    constexpr double kNear = 1e-4;  // of a frame
    const double first = std::ceil((scale.begin_s * fps - kNear) / double(step)), last = scale.end_s * fps + kNear;
    if (!(std::fabs(first * double(step)) < 1e15)) return frames;  // a file may have keys at any time
    for (double n = first * double(step); n <= last && frames.size() < 1000; n += double(step))
        frames.push_back(static_cast<long>(n));
    return frames;
}

}  // namespace clarity::ui
