#include "ui/widgets.hpp"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/error.hpp"
#include "ui/theme.hpp"

namespace clarity {
namespace {

// The one widget whose value is being edited but not in force yet.
struct PendingEdit {
    ImGuiID id = 0;
    int whole = 0;
    float real = 0;
} pending;

// After a slider: applies at once, or once it is let go.
template <class Value>
bool settled(ImGuiID id, bool edited, bool at_once, Value shown, Value& value, Value PendingEdit::*member) {
    const bool done = ImGui::IsItemDeactivatedAfterEdit();
    if (ImGui::IsItemActive()) {
        pending.id = id;
        pending.*member = shown;
    } else if (pending.id == id) {
        pending.id = 0;
    }
    if (!(at_once ? edited : done) || shown == value) return false;
    value = shown;
    return true;
}

// A slider's value as a bar from its left edge, under the number, instead of ImGui's grab, which covers it. Call before the
// slider, with its frame's colours off.
void draw_slider_bar(double value, double min, double max, bool logarithmic) {
    double share = max > min ? (value - min) / (max - min) : 0;
    if (logarithmic) {  // as ImGui maps it: zero is taken as the smallest number shown
        const double least = min > 0 ? min : 1e-3;
        share = std::log(std::max(value, least) / least) / std::log(max / least);
    }
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const ImVec2 to(from.x + ImGui::CalcItemWidth(), from.y + ImGui::GetFrameHeight());
    const auto end = from.x + (to.x - from.x) * static_cast<float>(std::clamp(share, 0.0, 1.0));
    const bool hovered = ImGui::IsMouseHoveringRect(from, to) && ImGui::IsWindowHovered();
    const float rounding = ImGui::GetStyle().FrameRounding;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(from, to, ImGui::GetColorU32(hovered ? ImGuiCol_FrameBgHovered : ImGuiCol_FrameBg), rounding);
    const ImVec4& accent = colors::kAccent;
    if (end > from.x + 1)
        list.AddRectFilled(from, {end, to.y}, ImGui::GetColorU32(ImVec4(accent.x, accent.y, accent.z, hovered ? 0.5f : 0.4f)),
                           rounding, end < to.x - 1 ? ImDrawFlags_RoundCornersLeft : ImDrawFlags_RoundCornersAll);
}

// Hides the frames of the sliders drawn while it lives.
struct BareFrames {
    BareFrames() {
        for (const ImGuiCol color : {ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive})
            ImGui::PushStyleColor(color, ImVec4(0, 0, 0, 0));
    }
    ~BareFrames() { ImGui::PopStyleColor(3); }
};

bool whole_slider(const char* id_text, int& value, int min, int max, bool at_once) {
    const ImGuiID id = ImGui::GetID(id_text);
    int shown = pending.id == id ? pending.whole : value;
    const bool wide = max - min > 100;
    const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | (wide ? ImGuiSliderFlags_Logarithmic : 0);
    draw_slider_bar(shown, min, max, wide);
    const BareFrames bare;
    const bool edited = ImGui::SliderInt(id_text, &shown, min, max, "%d", flags);
    return settled(id, edited, at_once, shown, value, &PendingEdit::whole);
}

bool real_slider(const char* id_text, double& value, double min, double max, bool at_once) {
    const ImGuiID id = ImGui::GetID(id_text);
    auto held = static_cast<float>(value);
    float shown = pending.id == id ? pending.real : held;
    const bool wide = max - min > 100;
    const char* format = max - min <= 0.1 ? "%.4f" : "%.3f";
    const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | (wide ? ImGuiSliderFlags_Logarithmic : 0);
    draw_slider_bar(shown, min, max, wide);
    const BareFrames bare;
    const bool edited = ImGui::SliderFloat(id_text, &shown, static_cast<float>(min), static_cast<float>(max), format, flags);
    if (!settled(id, edited, at_once, shown, held, &PendingEdit::real)) return false;
    value = held;
    return true;
}

constexpr float kLabelWidth = 130;

// The beginning of a text that fits.
std::string cut_to(std::string text, float width) {
    if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
    while (!text.empty() && ImGui::CalcTextSize((text + "\u2026").c_str()).x > width) {
        do text.pop_back();
        while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80);
        // A lead byte whose tail is gone goes too.
        while (!text.empty() && static_cast<unsigned char>(text.back()) >= 0xC0) text.pop_back();
    }
    return text + "\u2026";
}

std::map<std::string, Rect>& places() {
    static std::map<std::string, Rect> rects;
    return rects;
}

bool choice_combo(const char* id_text, int& index, const std::vector<std::string>& names) {
    const bool known = index >= 0 && index < static_cast<int>(names.size());
    if (!ImGui::BeginCombo(id_text, known ? names[static_cast<size_t>(index)].c_str() : "?")) return false;
    bool changed = false;
    for (int i = 0; i < static_cast<int>(names.size()); ++i) {
        const bool chosen = i == index;
        if (option(names[static_cast<size_t>(i)], chosen)) {
            index = i;
            changed = true;
        }
        if (chosen) ImGui::SetItemDefaultFocus();
    }
    ImGui::EndCombo();
    return changed;
}

// Sizes that people choose, by how large they may be.
const std::vector<std::string>& common_sizes(double max) {
    static const std::vector<std::string> packets = {"auto", "1x1", "2x2", "4x4", "8x2", "8x4", "8x8", "16x16"};
    static const std::vector<std::string> pictures = {"320x240",  "640x480",   "800x600",  "1024x768",
                                                      "1280x720", "1920x1080", "3840x2160"};
    return max <= 256 ? packets : pictures;
}

bool accepts(const Setting& row, const Settings& settings, const std::string& text) {
    Settings probe = settings;
    try {
        row.set(probe, text);
        return true;
    } catch (const Error&) {
        return false;
    }
}

// "WxH" typed, or chosen from a list. Edited text lives here until Enter or until the field is left.
bool size_field(const Setting& row, const Settings& settings, std::string& chosen) {
    static std::map<std::string, std::string> edited;
    const std::string now = row.get(settings);
    std::string& text = edited.try_emplace(row.key, now).first->second;
    const float arrow = ImGui::GetFrameHeight();
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - arrow);
    ImGui::InputText("##text", &text, ImGuiInputTextFlags_AutoSelectAll);
    const bool typed = ImGui::IsItemDeactivatedAfterEdit();
    if (!ImGui::IsItemActive() && !typed) text = now;
    bool picked = false;
    ImGui::SameLine(0, 0);
    if (ImGui::BeginCombo("##common", "", ImGuiComboFlags_NoPreview | ImGuiComboFlags_PopupAlignLeft)) {
        for (const std::string& size : common_sizes(row.max)) {
            if (!accepts(row, settings, size)) continue;
            if (option(size, size == now)) {
                chosen = size;
                picked = true;
            }
        }
        ImGui::EndCombo();
    }
    if (typed) chosen = text;
    return (typed || picked) && chosen != now;
}

// What a row said last to a value that it does not take; gone with the next good one.
std::map<std::string, std::string>& refusals() {
    static std::map<std::string, std::string> texts;
    return texts;
}

bool edit_value(const Setting& row, const Settings& settings, std::string& text) {
    const bool at_once = row.effect == Effect::frame;
    text = row.get(settings);
    switch (row.kind) {
        case Setting::Kind::integer: {
            int value = std::atoi(text.c_str());
            if (!whole_slider("##whole", value, static_cast<int>(row.min), static_cast<int>(row.max), at_once)) return false;
            text = std::to_string(value);
            return true;
        }
        case Setting::Kind::real: {
            double value = std::atof(text.c_str());
            if (!real_slider("##real", value, row.min, row.max, at_once)) return false;
            text = number_text(value);
            return true;
        }
        case Setting::Kind::boolean: {
            bool value = text == "true";
            if (!ImGui::Checkbox("##boolean", &value)) return false;
            text = value ? "true" : "false";
            return true;
        }
        case Setting::Kind::choice: {
            int index = -1;
            for (size_t i = 0; i < row.choices.size(); ++i)
                if (row.choices[i] == text) index = static_cast<int>(i);
            if (!choice_combo("##choice", index, row.choices)) return false;
            text = row.choices[static_cast<size_t>(index)];
            return true;
        }
        case Setting::Kind::size:
            return size_field(row, settings, text);
    }
    return false;
}

}  // namespace

void section(const char* title) {
    ImGui::Dummy({0, 6 * ui_scale()});
    ImGui::PushFont(fonts().bold);
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kDim);
    ImGui::TextUnformatted(title);
    ImGui::PopStyleColor();
    ImGui::PopFont();
    ImGui::Separator();
}

void tooltip(const std::string& text) {
    if (text.empty() || !ImGui::IsItemHovered()) return;
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(10 * ui_scale(), 8 * ui_scale()));
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(320 * ui_scale());
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
    ImGui::PopStyleVar();
}

bool option(const std::string& label, bool chosen) {
    const bool clicked = ImGui::Selectable(label.c_str(), chosen);
    const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
    places()[label] = {from.x, from.y, to.x - from.x, to.y - from.y};
    return clicked && !chosen;
}

bool slider(const char* id, float& value, float min, float max, const char* format, bool logarithmic) {
    const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | (logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    draw_slider_bar(value, min, max, logarithmic);
    const BareFrames bare;
    return ImGui::SliderFloat(id, &value, min, max, format, flags);
}

const Rect* drawn_place(const std::string& label) {
    const auto found = places().find(label);
    return found == places().end() ? nullptr : &found->second;
}

void row_label(const char* label, const std::string& help) {
    const float start = ImGui::GetCursorPosX(), width = kLabelWidth * ui_scale();
    ImGui::AlignTextToFramePadding();
    const std::string text = cut_to(label, width - 8 * ui_scale());
    ImGui::TextUnformatted(text.c_str());
    tooltip(text == label ? help : std::string(label) + "\n" + help);
    ImGui::SameLine(start + width);
    const ImVec2 from = ImGui::GetCursorScreenPos();
    places()[label] = {from.x, from.y, ImGui::GetContentRegionAvail().x, ImGui::GetFrameHeight()};
    ImGui::SetNextItemWidth(-FLT_MIN);
}

void row_text(const char* label, const std::string& value, const std::string& help) {
    const float start = ImGui::GetCursorPosX(), width = kLabelWidth * ui_scale();
    const std::string text = cut_to(label, width - 8 * ui_scale());
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kDim);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopStyleColor();
    tooltip(text == label ? help : std::string(label) + "\n" + help);
    ImGui::SameLine(start + width);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(value.c_str());
    ImGui::PopTextWrapPos();
}

void dim_text(const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kDim);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

bool setting_row(const Setting& row, Settings& settings) {
    ImGui::PushID(row.key.c_str());
    row_label(row.label.c_str(), row.help);
    std::string text;
    bool changed = false;
    if (edit_value(row, settings, text)) {
        try {
            row.set(settings, text);
            refusals().erase(row.key);
            changed = true;
        } catch (const Error& error) {
            refusals()[row.key] = error.what();
        }
    }
    if (const auto refusal = refusals().find(row.key); refusal != refusals().end()) {
        ImGui::PushStyleColor(ImGuiCol_Text, colors::kAmber);
        ImGui::TextWrapped("%s", refusal->second.c_str());
        ImGui::PopStyleColor();
    }
    ImGui::PopID();
    return changed;
}

bool parameter_row(const rt_param& param, double& value) {
    ImGui::PushID(param.key);
    row_label(param.label, param.help ? param.help : "");
    bool changed = false;
    if (param.kind == RT_PARAM_BOOL) {
        bool on = value != 0;
        changed = ImGui::Checkbox("##boolean", &on);
        value = on ? 1 : 0;
    } else if (param.kind == RT_PARAM_ENUM) {
        std::vector<std::string> names;
        for (const char* const* name = param.choices; name && *name; ++name) names.emplace_back(*name);
        int index = static_cast<int>(value);
        changed = choice_combo("##choice", index, names);
        value = index;
    } else if (param.kind == RT_PARAM_INT) {
        int whole = static_cast<int>(value);
        changed = whole_slider("##whole", whole, static_cast<int>(param.min), static_cast<int>(param.max), false);
        value = whole;
    } else {
        changed = real_slider("##real", value, param.min, param.max, false);
    }
    ImGui::PopID();
    return changed;
}

std::string number_text(double value) {
    char text[48];
    std::snprintf(text, sizeof text, value == std::floor(value) && std::abs(value) < 1e15 ? "%.0f" : "%.6g", value);
    return text;
}

std::string count_text(double count) {
    char text[48];
    if (count >= 1e9)
        std::snprintf(text, sizeof text, "%.2f G", count / 1e9);
    else if (count >= 1e6)
        std::snprintf(text, sizeof text, "%.2f M", count / 1e6);
    else if (count >= 1e4)
        std::snprintf(text, sizeof text, "%.1f k", count / 1e3);
    else
        std::snprintf(text, sizeof text, "%.0f", count);
    return text;
}

std::string bytes_text(double bytes) {
    char text[48];
    if (bytes >= 1024.0 * 1024 * 1024)
        std::snprintf(text, sizeof text, "%.2f GiB", bytes / (1024.0 * 1024 * 1024));
    else if (bytes >= 1024.0 * 1024)
        std::snprintf(text, sizeof text, "%.1f MiB", bytes / (1024.0 * 1024));
    else
        std::snprintf(text, sizeof text, "%.1f KiB", bytes / 1024.0);
    return text;
}

}  // namespace clarity
