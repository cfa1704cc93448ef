
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "ui/widgets/formats.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

// The value of the one widget that is being edited and does not apply yet.
struct PendingEdit {
    ImGuiID id = 0;
    int whole = 0;
    float real = 0;
} pending;

// For the widget just drawn: whether its value applies now. It applies at once, or when the mouse button is released.
template <class Value>
bool settled(ImGuiID id, bool edited, bool at_once, Value shown, Value& value, Value PendingEdit::* member) {
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

bool whole_slider(const char* id_text, int& value, int min, int max, bool at_once) {
    const ImGuiID id = ImGui::GetID(id_text);
    int shown = pending.id == id ? pending.whole : value;
    const bool wide = max - min > 100;
    const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | (wide ? ImGuiSliderFlags_Logarithmic : 0);
    draw_slider_bar(shown, min, max, wide);
    const BareFrames bare;
    // ImGui ends the program for a slider with a wider range.
    constexpr int kMost = std::numeric_limits<int>::max() / 2;
    const bool edited = ImGui::SliderInt(id_text, &shown, std::max(min, -kMost), std::min(max, kMost), "%d", flags);
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
    value = short_double(held);
    return true;
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

// Common sizes to choose from, for the largest value that is allowed.
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

// A field for "WxH", typed or chosen from a list. Typed text stays here until Enter is pressed or the field is left.
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

// For each row with a refused value: the last error. The next valid value removes it.
std::map<std::string, std::string>& refusals() {
    static std::map<std::string, std::string> texts;
    return texts;
}

// The buttons of a row in one line. Returns whether one was pressed; its value is then in `text`.
bool value_buttons(const Setting& row, std::string& text) {
    const float width = share_of_line(static_cast<int>(row.buttons.size()));
    bool pressed = false;
    for (const Setting::Button& each : row.buttons) {
        if (&each != row.buttons.data()) ImGui::SameLine();
        if (!toggle_button((each.label + "##" + row.key).c_str(), each.value == text, row.help, width) || each.value == text)
            continue;
        text = each.value;
        pressed = true;
    }
    return pressed;
}

bool edit_value(const Setting& row, const Settings& settings, std::string& text) {
    const bool at_once = row.at_once();
    text = row.get(settings);
    if (!row.buttons.empty()) {
        if (value_buttons(row, text)) return true;
        if (row.kind == Setting::Kind::choice) return false;
        row_label("");
    }
    switch (row.kind) {
        case Setting::Kind::integer: {
            int value = std::atoi(text.c_str());
            if (!whole_slider("##whole", value, static_cast<int>(row.min), static_cast<int>(row.max), at_once)) return false;
            text = std::to_string(value);
            return true;
        }
        case Setting::Kind::real: {
            double value = 0;
            read_number(text, value);
            if (!real_slider("##real", value, row.min, row.max, at_once)) return false;
            text = exact_text(value);
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

}  // namespace clarity::ui
