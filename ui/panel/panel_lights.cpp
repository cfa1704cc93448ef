// The rows of the lights and of the camera's bookmarks.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "scene/light_kinds.hpp"
#include "ui/panel/panel.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

// A new light of a kind. One with a place is above the target, one without shines from the camera's side.
rt_light new_light(const Session& session, rt_u32 kind) {
    rt_light light = default_light(kind);
    const Camera& camera = session.desired.camera;
    const bool has_place = light_kind_of(light).has_place;
    for (int i = 0; i < 3; ++i) {
        const float towards = camera.eye[i] - camera.target[i] + camera.up[i] * scene_size(session) * 0.3f;
        light.position[i] = has_place ? camera.target[i] + towards : towards;
    }
    // Edges and radii are a twentieth of the scene.
    for (const Key& key : light_kind_of(light).keys) {
        if (key.moves != Moves::vector && key.moves != Moves::length) continue;
        std::array<float, 3> value = value_of(key, &light);
        for (float& x : value) x *= scene_size(session) * 0.05f;
        set_value(key, &light, value);
    }
    make_sound(light);
    return light;
}

// It keeps its colour, and its place if both kinds have one.
void change_kind(const Session& session, rt_light& light, rt_u32 kind) {
    rt_light changed = new_light(session, kind);
    std::copy_n(light.color, 3, changed.color);
    if (light_kind_of(light).has_place == light_kind_of(changed).has_place) std::copy_n(light.position, 3, changed.position);
    light = changed;
}

void add_light(Session& session) {
    DesiredLight light;
    light.name = "light " + std::to_string(session.desired.lights.size() + 1);
    light.values = new_light(session, RT_LIGHT_POINT);
    for (float& x : light.values.color) x = 0.5f;
    session.desired.lights.push_back(light);
    session.selected_light = static_cast<unsigned>(session.desired.lights.size()) - 1;
}

void kind_row(const Session& session, rt_light& light) {
    std::string help;
    for (const LightKind& kind : light_kinds()) help += (help.empty() ? "" : "; ") + std::string(kind.label) + ": " + kind.help;
    row_label("Kind", help);
    if (!ImGui::BeginCombo("##kind", light_kind_of(light).label)) return;
    for (const LightKind& kind : light_kinds())
        if (option(kind.label, light.kind == kind.kind) && light.kind != kind.kind) change_kind(session, light, kind.kind);
    ImGui::EndCombo();
}

void light_list(Session& session) {
    auto& lights = session.desired.lights;
    const float line = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.y;
    const size_t shown = std::min<size_t>(lights.size(), 6);
    ImGui::BeginChild("lights", {0, static_cast<float>(shown) * line}, false);
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(lights.size()), line);
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            DesiredLight& light = lights[static_cast<size_t>(i)];
            ImGui::PushID(i);
            ImGui::Checkbox("##on", &light.on);
            note_rect("on " + light.name);
            tooltip("switch this light on or off");
            ImGui::SameLine();
            const float swatch = ImGui::GetFrameHeight();
            ImGui::AlignTextToFramePadding();
            const ImVec2 size(std::max(10.0f, ImGui::GetContentRegionAvail().x - swatch - 10 * ui_scale()), 0);
            const bool chosen = session.selected_light == static_cast<unsigned>(i);
            if (ImGui::Selectable(cut_to(light.name, size.x).c_str(), chosen, 0, size)) session.selected_light = unsigned(i);
            note_rect(light.name);
            tooltip("select this light: the keys move the selected light");
            ImGui::SameLine();
            const float* c = light.values.color;
            const float most = std::max({c[0], c[1], c[2], 1e-6f});
            ImGui::ColorButton("##colour", {c[0] / most, c[1] / most, c[2] / most, 1},
                               ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoPicker, {swatch, swatch});
            ImGui::PopID();
        }
    ImGui::EndChild();
}

}  // namespace

void draw_light_rows(Session& session, UiState& state) {
    auto& lights = session.desired.lights;
    const float half = share_of_line(2);
    if (toggle_button("Show in the picture", state.show_lights, "as handles that can be dragged (L)", half))
        state.show_lights = !state.show_lights;
    ImGui::SameLine();
    if (button("Add a light", "a lamp above the camera", half)) add_light(session);
    if (lights.empty()) {
        dim_text("this scene has no lights");
        return;
    }
    light_list(session);
    session.selected_light = std::min<unsigned>(session.selected_light, static_cast<unsigned>(lights.size()) - 1);
    DesiredLight& light = lights[session.selected_light];
    kind_row(session, light.values);
    for (const Key& key : light_kind_of(light.values).keys) {
        std::array<float, 3> value = value_of(key, &light.values);
        if (key.alias || !key_row(key, value, scene_size(session))) continue;
        rt_light changed = light.values;
        set_value(key, &changed, value);
        if (make_sound(changed)) light.values = changed;
    }
    const auto ready = session.ready();
    const bool own = !ready || session.selected_light >= ready->loaded->first_view.lights.size();
    if (own && session.selected_light + 1 == lights.size() && button("Remove this light", {}, -FLT_MIN)) lights.pop_back();
}

void draw_bookmark_rows(Session& session, UiState& state) {
    if (button("Bookmark this view", "kept for this scene's file (B); N goes through them", -FLT_MIN))
        state.bookmarks.push_back(
            {"view " + std::to_string(state.bookmarks.size() + 1), session.desired.camera, session.desired.pose});
    size_t gone = state.bookmarks.size();
    for (size_t i = 0; i < state.bookmarks.size(); ++i) {
        Bookmark& bookmark = state.bookmarks[i];
        ImGui::PushID(static_cast<int>(i));
        const ImGuiStyle& style = ImGui::GetStyle();
        const float go = ImGui::CalcTextSize("Go").x + 2 * style.FramePadding.x, cross = ImGui::GetFrameHeight();
        ImGui::SetNextItemWidth(-go - cross - 2 * style.ItemSpacing.x);
        ImGui::InputText("##name", &bookmark.name);
        note_rect("name of bookmark " + std::to_string(i + 1));
        tooltip("click to rename");
        ImGui::SameLine();
        if (button("Go", "to this view", go)) go_to(session, bookmark.camera, bookmark.pose);
        note_rect("go to " + bookmark.name);
        ImGui::SameLine();
        if (button("\u00d7", "delete this bookmark", cross)) gone = i;
        note_rect("forget " + bookmark.name);
        ImGui::PopID();
    }
    if (gone < state.bookmarks.size()) state.bookmarks.erase(state.bookmarks.begin() + static_cast<std::ptrdiff_t>(gone));
}

}  // namespace clarity::ui
