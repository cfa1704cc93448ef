// The textures of the selected object's material, by use: which picture each has, and the choice of others.
#include <imgui.h>

#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"
#include "ui/panel/panel.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

std::string shown_name(const Scene& scene, rt_u32 texture) {
    if (texture == RT_NONE) return "none";
    const std::string name = texture_name(scene, texture);
    return is_picture_name(name) ? file_name(name) : name;
}

// Whether the material's model heeds such a texture.
bool is_heeded(const MaterialValues& values, rt_u32 use) {
    switch (use) {
        case RT_MAP_COLOR:
        case RT_MAP_NORMAL:
        case RT_MAP_OCCLUSION:
            return true;
        case RT_MAP_THICKNESS:
        case RT_MAP_CLEARCOAT_NORMAL:
        case RT_MAP_IRIDESCENCE_THICKNESS:
            return values.model == RT_MODEL_GLTF;
        default:
            break;
    }
    for (const char* const* key = map_uses()[use].multiplies.data(); *key; ++key)
        if (has_key(values.model, material_key(*key))) return true;
    return false;
}

std::string facts(const Scene& scene, rt_u32 texture, const MapUse& use) {
    const std::string key = std::string("`") + use.name + "` in text scenes";
    if (texture == RT_NONE) return key;
    const rt_texture& t = scene.textures[texture];
    return texture_name(scene, texture) + "\n" + std::to_string(t.width) + " x " + std::to_string(t.height) + ", " + key;
}

void use_row(Session& session, UiState& state, const Scene& scene, rt_u32 material, rt_u32 use) {
    const MapUse& row = map_uses()[use];
    const rt_u32 now = session.desired.maps.texture_of(scene, material, use);
    row_label(row.label, std::string("texture: ") + row.help);
    const bool is_open =
        ImGui::BeginCombo((std::string("##") + row.name).c_str(), shown_name(scene, now).c_str(), ImGuiComboFlags_HeightLarge);
    note_rect(row.name);
    if (!is_open) return tooltip(facts(scene, now, row));
    if (option("none", now == RT_NONE)) give_texture(session, material, use, RT_NONE);
    if (option("a picture\u2026", false)) {
        state.picture_for = {material, use};
        state.browse(BrowseFor::picture);
    }
    ImGui::Separator();
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(scene.textures.size()));
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const auto texture = static_cast<rt_u32>(i);
            ImGui::PushID(i);
            if (option(shown_name(scene, texture), texture == now)) give_texture(session, material, use, texture);
            tooltip(facts(scene, texture, row));
            ImGui::PopID();
        }
    ImGui::EndCombo();
}

}  // namespace

void draw_texture_rows(Session& session, UiState& state, rt_u32 material) {
    const Scene& scene = *session.ready()->loaded->scene;
    const MaterialValues& values = clarity::ui::material(session, material);
    std::vector<rt_u32> others;
    ImGui::PushID("textures");
    dim_text("Textures");
    for (rt_u32 use = 0; use < RT_MAP_USES; ++use) {
        const bool has = session.desired.maps.texture_of(scene, material, use) != RT_NONE;
        if (has || use == RT_MAP_COLOR || state.empty_texture_row == std::make_pair(material, use))
            use_row(session, state, scene, material, use);
        else if (is_heeded(values, use))
            others.push_back(use);
    }
    row_label("More textures", "adds a row for a use that has no texture yet");
    if (ImGui::BeginCombo("##more", "choose a use", ImGuiComboFlags_HeightLarge)) {
        for (const rt_u32 use : others) {
            if (option(map_uses()[use].label, false)) state.empty_texture_row = {material, use};
            tooltip(map_uses()[use].help);
        }
        ImGui::EndCombo();
    }
    note_rect("More textures");
    ImGui::PopID();
}

}  // namespace clarity::ui
