// The rows that move, turn and scale the selected instance.
#include <imgui.h>

#include "ui/panel/panel.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

bool drag_row(const char* label, const char* help, float* values, float speed, float least = 0, float most = 0) {
    row_label(label, help);
    const bool changed = ImGui::DragFloat3((std::string("##") + label).c_str(), values, speed, least, most, "%.4g",
                                           ImGuiSliderFlags_NoRoundToFormat);
    note_rect(label);
    return changed;
}

}  // namespace

void draw_object_rows(Session& session, UiState& state) {
    const auto ready = session.ready();
    if (!ready) return;
    const Scene& scene = *ready->loaded->scene;
    if (session.selection.instance < 0 || static_cast<size_t>(session.selection.instance) >= scene.instances.size()) {
        dim_text(
            "Click on an object in the picture, or in the tree above, to move it. Spheres, planes, polygons and shapes stay.");
        return;
    }
    const auto number = static_cast<rt_u32>(session.selection.instance);
    InstanceShift shift = session.desired.instances.shift_of(number);
    ImGui::PushID(static_cast<int>(number));
    bool changed = drag_row("Move", "from where the file or its clip has it, along the world's axes", shift.translate.data(),
                            scene_size(session) * 0.002f);
    changed |= drag_row("Turn", "degrees about the world's x, then y, then z, about the middle of its box",
                        shift.degrees.data(), 0.5f);
    changed |= drag_row("Scale", "along the world's axes, about the middle of its box, before it is turned", shift.scale.data(),
                        0.01f, 1e-3f, 1e3f);
    if (changed) session.desired.instances.set_shift(number, shift);
    ImGui::PopID();
    const float half = share_of_line(2);
    if (button(state.move_handles ? "Hide handles" : "Show handles",
               "in the picture: arrows move, rings turn, the square scales (M)", half))
        state.move_handles = !state.move_handles;
    ImGui::SameLine();
    ImGui::BeginDisabled(shift == InstanceShift());
    if (button("Put back", "to where the file or its clip has it", half)) session.desired.instances.set_shift(number, {});
    ImGui::EndDisabled();
}

}  // namespace clarity::ui
