#include "ui/panel/key_rows.hpp"

#include <imgui.h>

#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

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
