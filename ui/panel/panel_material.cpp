// The rows of the selected object's material.
#include <imgui.h>

#include <cstring>

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

bool share(const char* label, const char* help, float& value, float max, const char* format, bool logarithmic = false,
           float min = 0) {
    row_label(label, help);
    return slider((std::string("##") + label).c_str(), value, min, max, format, logarithmic);
}

bool value_rows(rt_material& values) {
    row_label("Colour", "diffuse reflectance, linear; also tints what is refracted");
    bool changed = color_field("##color", values.color);
    changed |= share("Mirror", "share of the light that is mirrored", values.reflect, 1, "%.3f");
    changed |= share("Refraction", "share of the light that Fresnel's equations split into a mirrored and a refracted part",
                     values.refract, 1, "%.3f");
    changed |=
        share("Index", "index of refraction inside: water 1.33, glass 1.5, diamond 2.42", values.ior, 3, "%.3f", false, 1);
    row_label("Highlight", "colour of the Blinn-Phong highlight, linear");
    changed |= color_field("##specular", values.specular);
    changed |= share("Shininess", "exponent of the highlight: a larger one makes a smaller highlight", values.shininess, 2000,
                     "%.1f", true, 1);
    row_label("Emission", "light of its own, linear; it lights nothing else");
    changed |= color_field("##emission", values.emission);
    return changed;
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
    rt_material values = material(session, index);
    ImGui::PushID(static_cast<int>(index));
    if (value_rows(values)) edited_material(session, index) = values;
    ImGui::PopID();
    if (values.texture != RT_NONE) dim_text("a texture multiplies the colour");
    if (values.flags & RT_MATERIAL_CHECKER) dim_text("a checkerboard of the colour and a third of it");
    const rt_material& own = scene.materials[index].values;
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
