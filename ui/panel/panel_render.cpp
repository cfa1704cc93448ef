// The Render tab: the settings of the picture. Rows come from the settings table, which gives their order, and from the
// plugins' parameters.
#include <imgui.h>

#include "ui/panel/panel.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"
#include "view/settings/settings.hpp"

namespace clarity::ui {
namespace {

// Draws the rows that choose which side the rows below edit, and how both sides are shown.
void compare_rows(Session& session, UiState& state) {
    if (!session.desired.other) return;
    section("COMPARE");
    row_label("Rows below are of", "the side that the rows for structure, device and tracing below change");
    const float half = share_of_line(2);
    const std::string names[2] = {"A  " + session.desired.main.settings.accel, "B  " + session.desired.other->settings.accel};
    for (int side = 0; side < 2; ++side) {
        if (side == 1) ImGui::SameLine();
        const std::string shown = cut_to(names[side], half - 2 * ImGui::GetStyle().FramePadding.x);
        if (toggle_button((shown + "##side" + std::to_string(side)).c_str(), session.editing_other == (side == 1), names[side],
                          half))
            session.editing_other = side == 1;
        note_rect(side == 0 ? "side A" : "side B");
    }
    row_label("Shown as", "wipe: drag the line between the pictures; difference: eight times as bright as it is");
    if (ImGui::BeginCombo("##mode", kCompareNames[static_cast<int>(state.compare_mode)])) {
        for (int i = 0; i < 3; ++i)
            if (option(kCompareNames[i], static_cast<int>(state.compare_mode) == i)) state.compare_mode = CompareMode(i);
        ImGui::EndCombo();
    }
    row_label("Equal time",
              "B gets as many samples as fit into the seconds of A's samples; the captions then compare their errors");
    ImGui::Checkbox("##equal time", &session.desired.equal_time);
    note_rect("Equal time");
    row_label("");
    const float width = share_of_line(2);
    if (button("Swap", "A becomes B and B becomes A (X)", width)) session.swap_sides();
    ImGui::SameLine();
    if (button("End", "back to one picture, that of A (C)", width)) session.compare(false);
}

const ReadySide* edited_ready(const Session& session) {
    const auto& ready = session.ready();
    if (!ready) return nullptr;
    if (session.editing_other && session.desired.other) return ready->other ? &*ready->other : nullptr;
    return &ready->main;
}

// A choice for --device: the devices in use plus this one, or without it if it is in use.
std::string with_or_without(const ReadySide& ready, const DeviceInfo& device) {
    std::string text;
    for (const DeviceInfo& used : ready.devices)
        if (used.id() != device.id()) text += (text.empty() ? "" : ",") + used.id();
    const bool used = ready.uses(device);
    return used ? text : text + (text.empty() ? "" : ",") + device.id();
}

void device_row(Session& session) {
    row_label("Device", "what computes the picture, one or several together; all OpenCL devices of all platforms, best first");
    const auto devices = session.devices();
    const auto keep = session.ready();  // keeps what `ready` points into
    const ReadySide* ready = edited_ready(session);
    std::string name = "looking for devices\u2026";
    if (devices && devices->empty()) name = "none found";
    if (ready) name = ready->device_name();
    if (ImGui::BeginCombo("##device", name.c_str())) {
        const std::vector<DeviceInfo> all = devices ? *devices : std::vector<DeviceInfo>();
        for (const DeviceInfo& device : all) {
            const bool chosen = ready && ready->devices_text() == device.id();
            if (option(device.id() + "  " + device.name, chosen)) session.edited().device = device.id();
            tooltip(device.platform + "\n" + device.version + "\ndriver " + device.driver);
        }
        if (all.size() > 1 && ready) {
            ImGui::Separator();
            dim_text("together, sharing each picture");
            for (const DeviceInfo& device : all) {
                bool used = ready->uses(device);
                const std::string text = with_or_without(*ready, device);
                if (ImGui::Checkbox((device.id() + "  " + device.name + "##together").c_str(), &used) && !text.empty())
                    session.edited().device = text;
            }
        }
        ImGui::EndCombo();
    }
    if (ready) tooltip(name);
}

void accel_rows(Session& session) {
    Settings& settings = session.edited().settings;
    const rt_plugin* current = session.plugins().accel(settings.accel);
    row_label("Structure", "the acceleration structure, in which rays search the scene; each is a plugin");
    if (ImGui::BeginCombo("##accel", current ? current->name : settings.accel.c_str(), ImGuiComboFlags_HeightLarge)) {
        for (const rt_plugin* plugin : session.plugins().accels()) {
            const bool chosen = plugin == current;
            if (option(plugin->name, chosen)) session.set_accel(plugin->id);
            tooltip(std::string(plugin->id) + (plugin->reference ? std::string("\n") + plugin->reference : ""));
        }
        ImGui::EndCombo();
    }
    current = session.plugins().accel(settings.accel);  // the structure may have changed above
    if (!current) return;
    if (settings.accel_params.size() != current->param_count) session.set_accel(current->id);
    ImGui::PushID(current->id);
    for (rt_u32 i = 0; i < current->param_count; ++i) parameter_row(current->params[i], settings.accel_params[i]);
    ImGui::PopID();
}

// Levels count from 1, the root, like the keys: "Level 3".
void level_rows(VolumeOverlay& overlay) {
    row_label("Show volumes", "bounding volumes of one level, drawn over the picture; keys 1 to 9, and 0 for the bottom level");
    const auto name = [](std::optional<rt_u32> level) {
        if (!level) return std::string("off");
        if (*level == RT_LEVEL_BOTTOM) return std::string("bottom level");
        return "level " + std::to_string(*level + 1) + (*level == 0 ? " (root)" : "");
    };
    if (ImGui::BeginCombo("##level", name(overlay.level()).c_str(), ImGuiComboFlags_HeightLarge)) {
        std::vector<std::optional<rt_u32>> levels = {std::nullopt};
        for (rt_u32 level = 0; level < 24; ++level) levels.emplace_back(level);
        levels.emplace_back(RT_LEVEL_BOTTOM);
        for (const auto& level : levels)
            if (option(name(level), level == overlay.level())) overlay.show(level);
        ImGui::EndCombo();
    }
    if (!overlay.level()) return;
    row_label("Hide behind", "volumes behind the picture's surfaces are left out; else they are faint");
    bool hides = overlay.hides_behind();
    if (ImGui::Checkbox("##behind", &hides)) overlay.hide_behind(hides);
}

void size_rows(Session& session, const UiState& state) {
    Settings& settings = session.desired.main.settings;
    row_label("");
    if (button("Fit the window",
               "as many pixels as the picture has room for: " + std::to_string(state.room_width) + "x" +
                   std::to_string(state.room_height),
               -FLT_MIN)) {
        settings.width = state.room_width;
        settings.height = state.room_height;
    }
    row_label("Resolution",
              "factor for width and height of the size above: less than 100 % is faster, more is finer than the screen");
    float percent = session.desired.resolution_scale * 100;
    if (slider("##scale", percent, 10, 200, "%.0f %%", true)) session.desired.resolution_scale = percent / 100;
    row_label(
        "While moving",
        "frames a second to hold while the camera or a light moves, with fewer pixels if necessary; 0: always all pixels");
    float fps = session.desired.moving_fps;
    if (slider("##fps", fps, 0, 120, fps < 0.5f ? "all pixels" : "%.0f frames/s"))
        session.desired.moving_fps = fps < 0.5f ? 0 : fps;
}

void part_row(Session& session) {
    const std::optional<PicturePart>& part = session.desired.part;
    row_label("Part", "Ctrl + drag on the picture: that part alone is traced, with the pixels of the whole picture; as --crop");
    if (!part) return dim_text("all of it");
    const Settings& settings = session.desired.main.settings;
    if (button((crop_text(*part, settings.width, settings.height) + "##part").c_str(), "trace all of it again (V)", -FLT_MIN))
        session.desired.part.reset();
    note_rect("Part");
}

void group_rows(SettingGroup group, Session& session, const UiState& state) {
    for (const Setting& row : settings_table()) {
        if (row.group != group || !row.used(session.edited().settings)) continue;
        setting_row(row, session.settings_for(row.key));
        if (row.key == "size") {
            size_rows(session, state);
            part_row(session);
        }
    }
}

}  // namespace

void draw_render_tab(Session& session, VolumeOverlay& overlay, UiState& state) {
    if (session.not_in_force()) wrapped_text("Not in force: the picture shows the last settings that worked.", colors::kAmber);
    compare_rows(session, state);
    // The two sides have different widget ids, so that an unfinished edit stays with its side.
    ImGui::PushID(session.editing_other ? "b" : "a");
    section("STRUCTURE");
    accel_rows(session);
    level_rows(overlay);
    section("DEVICE");
    device_row(session);
    if (folding_section("TRACING")) group_rows(SettingGroup::tracing, session, state);
    if (picture_of_tracer(session.edited().settings.tracer) == kPathPicture && folding_section("PATHS"))
        group_rows(SettingGroup::paths, session, state);
    if (folding_section("PICTURE")) {
        if (session.desired.other) dim_text("of both sides");
        group_rows(SettingGroup::picture, session, state);
    }
    if (folding_section("MORE", false)) group_rows(SettingGroup::more, session, state);
    ImGui::PopID();
    draw_output_rows(session, state);
}

}  // namespace clarity::ui
