// The rows of the selected object's material.
#include <imgui.h>

#include <cmath>
#include <cstring>

#include "scene/material_keys.hpp"
#include "ui/panel/panel.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

constexpr float kPreviewSize = 120;  // pixels along a side, before scaling

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

// A ball of the material, with what there is to say of it at its right.
void preview_row(Session& session, const UiState& state, rt_u32 index) {
    const float size = std::round(kPreviewSize * ui_scale());
    session.want_preview(index, static_cast<unsigned>(size));
    const auto preview = session.preview();
    const bool is_there = preview && preview->material == index;
    if (is_there && state.preview_texture != 0)
        ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<intptr_t>(state.preview_texture)), {size, size});
    else
        ImGui::Dummy({size, size});
    note_rect("preview");
    tooltip("the material by the tracer `path`, on a floor of squares under a soft sky and a lamp");
    ImGui::SameLine();
    ImGui::BeginGroup();
    ImGui::PushTextWrapPos(0);
    if (is_there && !preview->failure.empty())
        wrapped_text("no preview: " + preview->failure, colors::kAmber);
    else if (!is_there || preview->samples == 0)
        dim_text("the preview is being made\u2026");
    else
        dim_text(plural(preview->samples, "sample"));
    ImGui::PopTextWrapPos();
    ImGui::EndGroup();
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

}  // namespace

void draw_material_rows(Session& session, UiState& state) {
    const auto ready = session.ready();
    if (!ready) return;
    const Scene& scene = *ready->loaded->scene;
    if (session.selection.material < 0 || static_cast<size_t>(session.selection.material) >= scene.materials.size()) {
        dim_text("Click on something in the picture, or in the tree above, to edit what it is made of.");
        return;
    }
    const auto index = static_cast<rt_u32>(session.selection.material);
    choose_material(session, scene, index);
    preview_row(session, state, index);
    MaterialValues values = material(session, index);
    ImGui::PushID(static_cast<int>(index));
    if (value_rows(values, scene_size(session))) edited_material(session, index) = values;
    ImGui::PopID();
    draw_texture_rows(session, state, index);
    const MaterialValues& own = scene.materials[index].values;
    MapEdits without = session.desired.maps;
    without.reset(index);
    const bool edited = std::memcmp(&material(session, index), &own, sizeof own) != 0 || without != session.desired.maps;
    ImGui::BeginDisabled(!edited);
    const float half = share_of_line(2);
    if (button("Reset material", "as the file has it", half)) {
        edited_material(session, index) = own;
        session.desired.maps = std::move(without);
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(session.desired.materials.empty() && session.desired.maps.empty());
    if (button("Reset all", "every material as the file has it", half)) {
        session.desired.materials.clear();
        session.desired.maps = {};
    }
    ImGui::EndDisabled();
}

}  // namespace clarity::ui
