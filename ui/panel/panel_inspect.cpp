// The Inspect tab: the tree of one pixel's rays, what each hit, and what it adds to the pixel.
#include <imgui.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.hpp"
#include "tracers/inspect/inspect.hpp"
#include "ui/overlay/ray_lines.hpp"
#include "ui/panel/panel.hpp"
#include "ui/session/session.hpp"
#include "ui/widgets/formats.hpp"
#include "ui/widgets/scene_rows.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"
#include "view/settings/settings.hpp"

namespace clarity::ui {
namespace {

// Describes the rays of a pixel in words and numbers.
// Sums over all rays of a pixel. steps counts visited nodes.
struct RayTotals {
    size_t traced = 0, shadow = 0, dropped = 0;
    size_t steps = 0, leaf_tests = 0;
};

// For each ray, the indices of the rays that it spawned, in order.
using RayChildren = std::vector<std::vector<int>>;

std::string what_it_hit(const RayRecord& ray, const Scene& scene) {
    if (ray.prim < 0) return "nothing";
    const PrimPlace place = place_of_prim(scene, ray.prim);
    switch (place.kind) {
        case PrimPlace::Kind::triangle:
            if (place.instance < scene.instances.size()) return row_name(scene, RowKind::instance, place.instance);
            return "prim " + std::to_string(ray.prim);
        case PrimPlace::Kind::sphere:
            return row_name(scene, RowKind::sphere, place.index);
        case PrimPlace::Kind::polygon:
            return row_name(scene, RowKind::polygon, place.index);
        case PrimPlace::Kind::plane:
            return row_name(scene, RowKind::plane, place.index);
        case PrimPlace::Kind::shape:
            return row_name(scene, RowKind::shape, place.index);
        case PrimPlace::Kind::none:
            break;
    }
    return "prim " + std::to_string(ray.prim);
}

const char* kind_name(RayRecord::Kind kind) {
    switch (kind) {
        case RayRecord::Kind::camera:
            return "camera";
        case RayRecord::Kind::mirror:
            return "mirror";
        case RayRecord::Kind::refracted:
            return "refracted";
        case RayRecord::Kind::shadow:
            break;
    }
    return "shadow";
}

const char* fate_name(RayRecord::Fate fate) {
    switch (fate) {
        case RayRecord::Fate::traced:
            return "traced";
        case RayRecord::Fate::dropped:
            return "dropped: no ray slot was free";
        case RayRecord::Fate::too_light:
            return "not followed: adds too little";
        case RayRecord::Fate::too_deep:
            return "not followed: last generation";
        case RayRecord::Fate::unasked:
            break;
    }
    return "shadows are off";
}

std::string light_name(int index, const std::vector<std::string>& lights) {
    const bool known = index >= 0 && static_cast<size_t>(index) < lights.size();
    return known ? lights[static_cast<size_t>(index)] : "light " + std::to_string(index + 1);
}

std::string triple_text(const std::array<float, 3>& v) {
    char text[64];
    std::snprintf(text, sizeof text, "%.3g  %.3g  %.3g", static_cast<double>(v[0]), static_cast<double>(v[1]),
                  static_cast<double>(v[2]));
    return text;
}

RayTotals totals_of(const RayTree& tree) {
    RayTotals totals;
    for (const RayRecord& ray : tree.rays) {
        totals.dropped += ray.fate == RayRecord::Fate::dropped;
        if (ray.fate != RayRecord::Fate::traced) continue;
        ++totals.traced;
        totals.shadow += ray.kind == RayRecord::Kind::shadow;
        totals.steps += ray.steps;
        totals.leaf_tests += ray.leaf_tests;
    }
    return totals;
}

RayChildren children_of(const RayTree& tree) {
    RayChildren children(tree.rays.size());
    for (size_t i = 0; i < tree.rays.size(); ++i) {
        const int parent = tree.rays[i].parent;
        if (parent >= 0 && static_cast<size_t>(parent) < i)
            children[static_cast<size_t>(parent)].push_back(static_cast<int>(i));
    }
    return children;
}

// The names of the lights that are on, in the order in which frames number them.
std::vector<std::string> names_of_lights(const Session& session) {
    std::vector<std::string> names;
    for (const DesiredLight& light : session.desired.lights)
        if (light.on) names.push_back(light.name);
    return names;
}

// "mirror \u2192 teapot", "light 1: in shadow", "refracted: too deep".
std::string ray_title(const RayRecord& ray, const Scene& scene, const std::vector<std::string>& lights) {
    if (ray.kind == RayRecord::Kind::shadow) {
        const char* outcome = ray.fate != RayRecord::Fate::traced ? fate_name(ray.fate) : ray.occluded ? "in shadow" : "lit";
        return light_name(ray.light_index, lights) + ": " + outcome;
    }
    if (ray.fate != RayRecord::Fate::traced) return std::string(kind_name(ray.kind)) + ", " + fate_name(ray.fate);
    return std::string(kind_name(ray.kind)) + " \u2192 " + what_it_hit(ray, scene);
}

// "12.3"; empty if there is no distance.
std::string ray_distance(const RayRecord& ray) {
    if (ray.fate != RayRecord::Fate::traced || !std::isfinite(ray.t)) return {};
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", static_cast<double>(ray.t));
    return text;
}

std::vector<std::pair<std::string, std::string>> ray_facts(const RayRecord& ray, const Scene& scene,
                                                           const std::vector<std::string>& lights) {
    std::vector<std::pair<std::string, std::string>> facts;
    const bool shadow = ray.kind == RayRecord::Kind::shadow, traced = ray.fate == RayRecord::Fate::traced;
    facts.emplace_back("Ray", std::string(kind_name(ray.kind)) + ", generation " + std::to_string(ray.generation));
    if (!traced) facts.emplace_back("Fate", fate_name(ray.fate));
    if (shadow) {
        facts.emplace_back("Light",
                           light_name(ray.light_index, lights) + (traced ? ray.occluded ? ", blocked" : ", seen" : ""));
    } else if (traced) {
        facts.emplace_back("Met", what_it_hit(ray, scene));
        if (ray.prim >= 0) facts.emplace_back("Primitive", std::to_string(ray.prim));
        if (ray.material >= 0 && static_cast<size_t>(ray.material) < scene.materials.size())
            facts.emplace_back("Material", row_name(scene, RowKind::material, static_cast<size_t>(ray.material)));
    }
    if (traced)
        facts.emplace_back(shadow ? "Distance to light" : "Distance", std::isfinite(ray.t) ? ray_distance(ray) : "endless");
    facts.emplace_back("Weight", triple_text(ray.weight));
    facts.emplace_back("Light added", triple_text(ray.light));
    if (traced) facts.emplace_back("Nodes visited", std::to_string(ray.steps));
    if (traced) facts.emplace_back("Leaf tests", std::to_string(ray.leaf_tests));
    facts.emplace_back("Origin", triple_text(ray.origin));
    facts.emplace_back("Direction", triple_text(ray.direction));
    return facts;
}

// The facts as lines of text, for a tooltip.
std::vector<std::string> ray_lines_of(const RayRecord& ray, const Scene& scene, const std::vector<std::string>& lights) {
    std::vector<std::string> lines;
    for (const auto& [label, value] : ray_facts(ray, scene, lights)) lines.push_back(label + ": " + value);
    return lines;
}

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
