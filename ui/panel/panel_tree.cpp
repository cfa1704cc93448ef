// The tree of the scene. Only visible rows are drawn, so that 100 000 instances cost no more than ten.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "ui/panel/panel.hpp"
#include "ui/session/session_view.hpp"
#include "ui/widgets/imgui_calls.hpp"
#include "ui/widgets/scene_rows.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

struct Tree {
    SceneRows rows;
    std::string filter;
    std::array<bool, kRowKinds> open{true, true, true, true, true, false, false, false, false};
    std::shared_ptr<const Scene> scene;
    PrimNumbers numbers;
    Selection shown;  // selection that the list was scrolled to last
};
Tree tree;

void title_row(const SceneRow& row, size_t total) {
    const auto kind = static_cast<size_t>(row.kind);
    const bool open = tree.open[kind] || !tree.filter.empty();
    std::string text = std::string(open ? "\u25be " : "\u25b8 ") + kind_title(row.kind) + "  " + std::to_string(row.count);
    if (row.count != total) text += " of " + std::to_string(total);
    ImGui::PushStyleColor(ImGuiCol_Text, colors::kDim);
    if (ImGui::Selectable(text.c_str())) tree.open[kind] = !tree.open[kind];
    ImGui::PopStyleColor();
    note_rect(kind_title(row.kind));
}

rt_u32 material_of(const Scene& scene, const SceneRow& row) {
    return row_material(scene, row.kind, static_cast<size_t>(row.index));
}
rt_i32 prim_of(const SceneRow& row) {
    return row_prim(tree.numbers, row.kind, static_cast<size_t>(row.index));
}

bool is_selected(const Session& session, const Scene& scene, const SceneRow& row) {
    const Selection& s = session.selection;
    switch (row.kind) {
        case RowKind::instance:
            return s.instance == row.index;
        case RowKind::material:
            return s.material == row.index;
        case RowKind::light:
            return session.selected_light == static_cast<unsigned>(row.index);
        case RowKind::mesh:
            return s.instance >= 0 && scene.instances[static_cast<size_t>(s.instance)].mesh == static_cast<rt_u32>(row.index);
        case RowKind::camera:
            return false;
        default:
            return s.instance < 0 && s.prim >= 0 && s.prim == prim_of(row);
    }
}

void choose(Session& session, const Scene& scene, const SceneRow& row) {
    const auto index = static_cast<size_t>(row.index);
    const rt_u32 material = material_of(scene, row);
    if (row.kind == RowKind::light) {
        session.selected_light = static_cast<unsigned>(row.index);
    } else if (row.kind == RowKind::camera) {
        session.desired.camera = scene.cameras[index];
    } else if (row.kind == RowKind::mesh) {
        for (size_t i = 0; i < scene.instances.size(); ++i)
            if (scene.instances[i].mesh == index) return choose(session, scene, {RowKind::instance, static_cast<int>(i), 0});
    } else {
        session.selection = {row.kind == RowKind::instance ? row.index : -1, prim_of(row),
                             material == RT_NONE ? -1 : static_cast<rt_i32>(material)};
    }
    tree.shown = session.selection;
}

std::string amount(const Scene& scene, const SceneRow& row) {
    const auto i = static_cast<size_t>(row.index);
    if (row.kind == RowKind::instance) return count_text(scene.meshes[scene.instances[i].mesh].triangle_count);
    if (row.kind == RowKind::mesh) return count_text(scene.meshes[i].triangle_count);
    return {};
}

std::string help_text(const Scene& scene, const SceneRow& row, const std::string& name) {
    const auto i = static_cast<size_t>(row.index);
    std::string text = name;
    const rt_u32 material = material_of(scene, row);
    if (row.kind == RowKind::instance) {
        const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
        text += "\nmesh " + row_name(scene, RowKind::mesh, scene.instances[i].mesh) + ", " +
                plural(mesh.triangle_count, "triangle");
    }
    if (row.kind == RowKind::mesh)
        text += "\n" + plural(scene.meshes[i].triangle_count, "triangle") + ", " +
                std::to_string(scene.meshes[i].vertex_count) + " vertices";
    if (material != RT_NONE && row.kind != RowKind::material)
        text += "\nmaterial " + row_name(scene, RowKind::material, material);
    if (row.kind == RowKind::instance) text += "\nclick selects, double click brings it into view";
    if (row.kind == RowKind::camera) text += "\nclick to look through it";
    return text;
}

void eye_button(Session& session, rt_u32 instance, bool by_file) {
    const bool hidden = session.desired.instances.is_hidden(instance), seen = !hidden && by_file;
    ImGui::PushStyleColor(ImGuiCol_Text, seen ? colors::kText : colors::kDim);
    ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
    ImGui::BeginDisabled(!by_file);
    if (ImGui::SmallButton(seen ? "\u25c9##eye" : "\u25cb##eye")) session.desired.instances.hide(instance, !hidden);
    ImGui::EndDisabled();
    ImGui::PopStyleColor(2);
    tooltip(!by_file ? "the file hides it" : hidden ? "hidden: click to show it" : "click to hide it from the picture");
    ImGui::SameLine(0, 2 * ui_scale());
}

void item_row(Session& session, const Scene& scene, const SceneRow& row) {
    ImGui::PushID(static_cast<int>(row.kind) * 7 + 1);
    ImGui::PushID(row.index);
    const std::string name = row_name(scene, row.kind, static_cast<size_t>(row.index)), right = amount(scene, row);
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 12 * ui_scale());
    if (row.kind == RowKind::instance) {
        eye_button(session, static_cast<rt_u32>(row.index), scene.instances[static_cast<size_t>(row.index)].visible);
        note_rect("eye " + name);
    }
    const float room = ImGui::GetContentRegionAvail().x, width = right.empty() ? 0 : ImGui::CalcTextSize(right.c_str()).x;
    const ImVec2 from = ImGui::GetCursorScreenPos();
    if (ImGui::Selectable((cut_to(name, room - width - 12 * ui_scale()) + "##row").c_str(), is_selected(session, scene, row),
                          ImGuiSelectableFlags_AllowDoubleClick)) {
        choose(session, scene, row);
        if (ImGui::IsMouseDoubleClicked(0) && row.kind == RowKind::instance)
            focus_on_instance(session, static_cast<rt_u32>(row.index));
    }
    note_rect("row " + name);
    tooltip(help_text(scene, row, name));
    if (!right.empty())
        ImGui::GetWindowDrawList()->AddText({from.x + room - width - 2 * ui_scale(), from.y}, ImGui::GetColorU32(colors::kDim),
                                            right.c_str());
    ImGui::PopID();
    ImGui::PopID();
}

// Scrolls to what was picked in the picture.
void scroll_to_selection(const Session& session, const Scene& scene, const std::vector<SceneRow>& rows, float line) {
    const Selection &now = session.selection, &was = tree.shown;
    if (now.instance == was.instance && now.prim == was.prim && now.material == was.material) return;
    tree.shown = now;
    const auto selected = std::find_if(rows.begin(), rows.end(), [&](const SceneRow& row) {
        return row.index >= 0 && row.kind < RowKind::mesh && is_selected(session, scene, row);
    });
    if (selected == rows.end()) return;
    const float at = static_cast<float>(selected - rows.begin()) * line;
    ImGui::SetScrollY(std::max(0.0f, at - ImGui::GetWindowHeight() / 2));
}

}  // namespace

void draw_scene_tree(Session& session, UiState&) {
    const auto ready = session.ready();
    if (!ready) return;
    const std::shared_ptr<const Scene> scene = ready->loaded->scene;
    if (tree.scene != scene) {
        tree.scene = scene;
        tree.numbers = PrimNumbers(*scene);
        tree.filter.clear();
    }
    const bool some_hidden = !session.desired.instances.hidden.empty();
    const float all = ImGui::CalcTextSize("Show all objects").x + 2 * ImGui::GetStyle().FramePadding.x;
    ImGui::SetNextItemWidth(some_hidden ? -all - ImGui::GetStyle().ItemSpacing.x : -FLT_MIN);
    ImGui::InputTextWithHint("##filter", "find by name", &tree.filter);
    note_rect("find by name");
    if (some_hidden) {
        ImGui::SameLine();
        if (button("Show all objects", plural(session.desired.instances.hidden.size(), "object") + " hidden here", all))
            session.desired.instances.hidden.clear();
    }
    const std::vector<SceneRow>& rows = tree.rows.update(scene, tree.filter, tree.open);
    const float line = ImGui::GetTextLineHeightWithSpacing();
    const float height = std::clamp(static_cast<float>(rows.size()) + 0.8f, 2.0f, 11.0f) * line;
    ImGui::PushStyleColor(ImGuiCol_ChildBg, colors::kGround);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(6 * ui_scale(), 5 * ui_scale()));
    begin_padded_child("tree", {0, height});
    if (rows.empty()) dim_text("nothing of that name");
    scroll_to_selection(session, *scene, rows, line);
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(rows.size()), line);
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const SceneRow& row = rows[static_cast<size_t>(i)];
            row.index < 0 ? title_row(row, row_count(*scene, row.kind)) : item_row(session, *scene, row);
        }
    ImGui::EndChild();
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
}

}  // namespace clarity::ui
