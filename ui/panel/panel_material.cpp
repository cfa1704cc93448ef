// The rows of the selected object's material.
#include <imgui.h>

#include <cstring>

#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"
#include "ui/panel/key_rows.hpp"
#include "ui/panel/panel.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

std::string material_name(const Scene& scene, size_t index) {
    const std::string& name = scene.materials[index].name;
    return name.empty() ? "material " + std::to_string(index) : name;
}

void choose_material(Session& session, const Scene& scene, size_t current) {
    row_label("Material", "click on something in the picture or in the tree, or choose it here");
    if (!ImGui::BeginCombo("##material", material_name(scene, current).c_str(), ImGuiComboFlags_HeightLarge)) return;
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(scene.materials.size()));
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            ImGui::PushID(i);
            if (option(material_name(scene, static_cast<size_t>(i)), static_cast<size_t>(i) == current))
                session.selection = {-1, -1, i};
            ImGui::PopID();
        }
    ImGui::EndCombo();
}

bool value_rows(MaterialValues& values, float size) {
    bool changed = false;
    for (const Key& key : material_keys()) {
        if (!has_key(values.model, key)) continue;
        std::array<float, 3> value = value_of(key, &values);
        if (!key_row(key, value, size)) continue;
        set_material_value(values, key, value);
        changed = true;
    }
    return changed;
}

// The textures of a material, by use. They are those of its file.
void texture_rows(const Scene& scene, const Material& material, const MaterialValues& values) {
    const auto row = [&](const MapUse& use, rt_u32 texture) {
        row_label(use.label, std::string("texture: ") + use.help);
        ImGui::TextUnformatted(texture_name(scene, texture).c_str());
        const rt_texture& t = scene.textures[texture];
        tooltip(std::to_string(t.width) + " x " + std::to_string(t.height) + ", `" + use.name + "` in text scenes");
    };
    if (values.texture != RT_NONE) row(map_uses()[RT_MAP_COLOR], values.texture);
    each_map(scene, material, [&](const MapUse& use, const rt_map& map) { row(use, map.texture); });
}

}  // namespace

void draw_material_rows(Session& session) {
    const auto ready = session.ready();
    if (!ready) return;
    const Scene& scene = *ready->loaded->scene;
    if (session.selection.material < 0 || static_cast<size_t>(session.selection.material) >= scene.materials.size()) {
        dim_text("Click on something in the picture, or in the tree above, to edit what it is made of.");
        return;
    }
    const auto index = static_cast<rt_u32>(session.selection.material);
    choose_material(session, scene, index);
    MaterialValues values = material(session, index);
    ImGui::PushID(static_cast<int>(index));
    if (value_rows(values, scene_size(session))) edited_material(session, index) = values;
    ImGui::PopID();
    texture_rows(scene, scene.materials[index], values);
    const MaterialValues& own = scene.materials[index].values;
    const bool edited = std::memcmp(&material(session, index), &own, sizeof own) != 0;
    ImGui::BeginDisabled(!edited);
    const float half = share_of_line(2);
    if (button("Reset material", "as the file has it", half)) edited_material(session, index) = own;
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(session.desired.materials.empty());
    if (button("Reset all", "every material as the file has it", half)) session.desired.materials.clear();
    ImGui::EndDisabled();
}

}  // namespace clarity::ui
