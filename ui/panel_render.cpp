// The tab that tunes the picture. Rows come from the settings table and from the plugins' parameters; what is named here only
// gives them an order, and a row that is not named appears at the end.
#include <imgui.h>

#include <algorithm>

#include "ui/panel.hpp"
#include "ui/theme.hpp"
#include "ui/widgets.hpp"

namespace clarity {
namespace {

struct Group {
    const char* title;
    std::vector<const char*> keys;
};
const std::vector<Group>& groups() {
    static const std::vector<Group> all = {
        {"TRACING", {"tracer", "depth", "packet", "lanes", "ray_slots", "shadows", "min_weight"}},
        {"PICTURE", {"size", "spp", "aov", "exposure", "tone"}},
    };
    return all;
}

void device_row(Session& session) {
    row_label("Device", "what computes the picture; all OpenCL devices of all platforms, best first");
    const auto devices = session.devices();
    const auto ready = session.ready();
    std::string name = "looking for devices\u2026";
    if (devices && devices->empty()) name = "none found";
    if (ready) name = ready->main.device->info().name;
    if (ImGui::BeginCombo("##device", name.c_str())) {
        for (const DeviceInfo& device : devices ? *devices : std::vector<DeviceInfo>()) {
            const bool chosen = ready && ready->main.device->info().id() == device.id();
            if (option(device.id() + "  " + device.name, chosen)) session.edited().device = device.id();
            tooltip(device.platform + "\n" + device.version + "\ndriver " + device.driver);
        }
        ImGui::EndCombo();
    }
    if (ready) tooltip(name);
}

void accel_rows(Session& session) {
    Settings& settings = session.edited().settings;
    const rt_plugin* current = session.plugins().accel(settings.accel);
    row_label("Structure", "how the scene is held for tracing; each is a plugin");
    if (ImGui::BeginCombo("##accel", current ? current->name : settings.accel.c_str())) {
        for (const rt_plugin* plugin : session.plugins().accels()) {
            const bool chosen = plugin == current;
            if (option(plugin->name, chosen)) session.set_accel(plugin->id);
            tooltip(std::string(plugin->id) + (plugin->reference ? std::string("\n") + plugin->reference : ""));
        }
        ImGui::EndCombo();
    }
    current = session.plugins().accel(settings.accel);  // it may just have been chosen
    if (!current) return;
    if (settings.accel_params.size() != current->param_count) session.set_accel(current->id);
    ImGui::PushID(current->id);
    for (rt_u32 i = 0; i < current->param_count; ++i) parameter_row(current->params[i], settings.accel_params[i]);
    ImGui::PopID();
}

// "Level 3" counts from 1, the root, as the keys do.
void level_row(VolumeOverlay& overlay) {
    row_label("Show volumes", "bounding volumes of one level, drawn over the picture; keys 1 to 9, and 0 for the bottom level");
    const auto name = [](std::optional<rt_u32> level) {
        if (!level) return std::string("off");
        if (*level == RT_LEVEL_BOTTOM) return std::string("bottom level");
        return "level " + std::to_string(*level + 1) + (*level == 0 ? " (root)" : "");
    };
    if (!ImGui::BeginCombo("##level", name(overlay.level()).c_str(), ImGuiComboFlags_HeightLarge)) return;
    std::vector<std::optional<rt_u32>> levels = {std::nullopt};
    for (rt_u32 level = 0; level < 24; ++level) levels.emplace_back(level);
    levels.emplace_back(RT_LEVEL_BOTTOM);
    for (const auto& level : levels)
        if (option(name(level), level == overlay.level())) overlay.show(level);
    ImGui::EndCombo();
}

void fit_button(Settings& settings, const UiState& state) {
    row_label("");
    if (ImGui::Button("Fit the window", {-FLT_MIN, 0})) {
        settings.width = state.room_width;
        settings.height = state.room_height;
    }
    tooltip("as many pixels as the picture has room for: " + std::to_string(state.room_width) + "x" +
            std::to_string(state.room_height));
}

bool in_a_group(const std::string& key) {
    for (const Group& group : groups())
        if (std::any_of(group.keys.begin(), group.keys.end(), [&](const char* k) { return key == k; })) return true;
    return false;
}

}  // namespace

void draw_render_tab(Session& session, VolumeOverlay& overlay, const UiState& state) {
    if (session.behind() && !session.activity().busy) {
        ImGui::PushStyleColor(ImGuiCol_Text, colors::kAmber);
        ImGui::TextWrapped("Not in force: the picture shows the last settings that worked.");
        ImGui::PopStyleColor();
    }
    section("DEVICE");
    device_row(session);
    section("ACCELERATION STRUCTURE");
    accel_rows(session);
    level_row(overlay);
    for (const Group& group : groups()) {
        section(group.title);
        for (const char* key : group.keys)
            if (const Setting* row = find_setting(key)) {
                setting_row(*row, session.edited().settings);
                if (row->key == "size") fit_button(session.edited().settings, state);
            }
    }
    section("MORE");
    for (const Setting& row : settings_table())
        if (!in_a_group(row.key)) setting_row(row, session.edited().settings);
}

}  // namespace clarity
