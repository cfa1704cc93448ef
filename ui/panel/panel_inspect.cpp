// The Inspect tab: the tree of one pixel's rays, what each hit, and what it adds to the pixel.
#include <imgui.h>

#include <cmath>
#include <cstdio>

#include "render/settings/tracer_choice.hpp"
#include "ui/overlay/ray_lines.hpp"
#include "ui/panel/panel.hpp"
#include "ui/widgets/ray_text.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

void swatch(const std::array<float, 3>& linear, float size) {
    float c[3];
    for (int k = 0; k < 3; ++k) c[k] = std::pow(std::fmin(std::fmax(linear[static_cast<size_t>(k)], 0.0f), 1.0f), 1 / 2.2f);
    ImGui::ColorButton("##swatch", {c[0], c[1], c[2], 1}, ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoPicker,
                       {size, size});
}

void pixel_rows(const Inspection& inspection) {
    row_text("Pixel", std::to_string(inspection.x) + ", " + std::to_string(inspection.y),
             "from the picture's upper left corner");
    const std::array<float, 3>& color = inspection.result.color;
    row_text("Colour", triple_text(color), "colour of the pixel's first sample: linear light before exposure and tone mapping");
    ImGui::SameLine();
    swatch(color, ImGui::GetTextLineHeight());
    const RayTotals totals = totals_of(inspection.result);
    row_text("Rays", plural(totals.traced, "ray") + ", " + std::to_string(totals.shadow) + " of them to lights",
             "traced for this pixel");
    row_text("Work", plural(totals.steps, "node") + " visited, " + plural(totals.leaf_tests, "primitive") + " tested",
             "by all of these rays");
    if (totals.dropped > 0)
        row_text("Dropped", plural(totals.dropped, "ray"), "the packet's ray slots were full: raise `Ray slots`",
                 colors::kAmber);
    if (inspection.result.truncated) wrapped_text("There were more rays than are listed.", colors::kAmber);
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
    return text;
}

void draw_ray(const Session& session, const Inspection& inspection, const RayChildren& children, int index, UiState& state) {
    const RayRecord& ray = inspection.result.rays[static_cast<size_t>(index)];
    const std::vector<int>& below = children[static_cast<size_t>(index)];
    ImGui::PushID(index);
    ImGuiTreeNodeFlags flags =
        ImGuiTreeNodeFlags_DefaultOpen | ImGuiTreeNodeFlags_OpenOnArrow | ImGuiTreeNodeFlags_SpanAvailWidth;
    if (below.empty()) flags |= ImGuiTreeNodeFlags_Leaf;
    if (state.selected_ray == index) flags |= ImGuiTreeNodeFlags_Selected;
    const RayKind& kind = ray_kinds()[ray_kind_of(ray)];
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const Scene& scene = *inspection.job.ready->scene;
    const std::vector<std::string> light_names = names_of_lights(session);
    const bool open = ImGui::TreeNodeEx("##ray", flags);
    if (ImGui::IsItemClicked()) state.selected_ray = state.selected_ray == index ? -1 : index;
    note_rect("ray " + std::to_string(index));
    if (ImGui::IsItemHovered()) tooltip(joined(ray_lines_of(ray, scene, light_names)));
    const float indent = ImGui::GetTreeNodeToLabelSpacing(), height = ImGui::GetTextLineHeight();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float dot = height * 0.28f;
    list.AddCircleFilled({at.x + indent + dot, at.y + height / 2}, dot, kind.color);
    const float left = at.x + indent + 3 * dot + 2 * ui_scale();
    const std::string right = ray_distance(ray);
    const float end = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    const float width = right.empty() ? 0 : ImGui::CalcTextSize(right.c_str()).x + 8 * ui_scale();
    const bool faint = ray.fate != RayRecord::Fate::traced;
    list.AddText({left, at.y}, ImGui::GetColorU32(faint ? colors::kDim : colors::kText),
                 cut_to(ray_title(ray, scene, light_names), end - left - width).c_str());
    if (!right.empty()) list.AddText({end - width + 8 * ui_scale(), at.y}, ImGui::GetColorU32(colors::kDim), right.c_str());
    if (open) {
        for (const int child : below) draw_ray(session, inspection, children, child, state);
        ImGui::TreePop();
    }
    ImGui::PopID();
}

void selected_rows(const Session& session, const Inspection& inspection, const UiState& state) {
    const auto& rays = inspection.result.rays;
    if (state.selected_ray < 0 || static_cast<size_t>(state.selected_ray) >= rays.size()) {
        dim_text("A click on a ray marks it in the picture and shows its numbers here.");
        return;
    }
    const RayRecord& ray = rays[static_cast<size_t>(state.selected_ray)];
    for (const auto& [label, value] : ray_facts(ray, *inspection.job.ready->scene, names_of_lights(session)))
        row_text(label.c_str(), value);
}

void legend() {
    bool first = true;
    for (const RayKind& kind : ray_kinds()) {
        const float dot = ImGui::GetTextLineHeight() * 0.28f;
        if (!first) same_line_if_fits((std::string(kind.name) + "xxx").c_str());
        first = false;
        const ImVec2 at = ImGui::GetCursorScreenPos();
        ImGui::GetWindowDrawList()->AddCircleFilled({at.x + dot, at.y + ImGui::GetTextLineHeight() / 2}, dot, kind.color);
        ImGui::Dummy({2.4f * dot, ImGui::GetTextLineHeight()});
        ImGui::SameLine(0, 2 * ui_scale());
        ImGui::PushStyleColor(ImGuiCol_Text, colors::kDim);
        ImGui::TextUnformatted(kind.name);
        ImGui::PopStyleColor();
    }
}

}  // namespace

void draw_inspect_tab(Session& session, UiState& state) {
    ImGui::Dummy({0, 4 * ui_scale()});
    const float half = share_of_line(2);
    if (toggle_button("Follow the mouse", state.inspect_hover, "the pixel under the mouse is inspected (R); a click keeps it",
                      half))
        state.inspect_hover = !state.inspect_hover;
    ImGui::SameLine();
    if (toggle_button("Draw the rays", state.show_rays, "draw the inspected rays as lines in the scene, over the picture",
                      half))
        state.show_rays = !state.show_rays;
    const auto inspection = session.inspector().latest();
    if (!inspection) {
        ImGui::Dummy({0, 6 * ui_scale()});
        dim_text(
            "The inspector follows every ray behind one pixel: what the camera ray meets, what is mirrored and refracted from "
            "there, and which lights are seen.\n\nSwitch \"Follow the mouse\" on and move over the picture, or click into the "
            "picture.");
        return;
    }
    section("PIXEL");
    if (!inspection->failure.empty()) {
        wrapped_text(inspection->failure, colors::kAmber);
        return;
    }
    pixel_rows(*inspection);
    if (picture_of_tracer(session.desired.main.settings.tracer) == std::string(kPathPicture))
        draw_noise_rows(session, state, inspection->x, inspection->y);
    section("RAYS");
    legend();
    ImGui::PushStyleVar(ImGuiStyleVar_IndentSpacing, 14 * ui_scale());
    const RayChildren children = children_of(inspection->result);
    for (size_t i = 0; i < inspection->result.rays.size(); ++i)
        if (inspection->result.rays[i].parent < 0) draw_ray(session, *inspection, children, static_cast<int>(i), state);
    ImGui::PopStyleVar();
    section("CHOSEN RAY");
    selected_rows(session, *inspection, state);
}

}  // namespace clarity::ui
