// The rows of the Inspect tab that show the random numbers of a pixel's samples: two dimensions of them, in their strata.
#include <imgui.h>

#include <algorithm>
#include <cstdio>

#include "ui/panel/panel.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

void dimension_row(const char* label, const char* help, unsigned dimensions, int& chosen) {
    chosen = std::clamp(chosen, 0, static_cast<int>(dimensions) - 1);
    row_label(label, help);
    if (!ImGui::BeginCombo((std::string("##") + label).c_str(), dimension_name(static_cast<unsigned>(chosen)).c_str(),
                           ImGuiComboFlags_HeightLarge))
        return;
    for (unsigned d = 0; d < dimensions; ++d)
        if (option(dimension_name(d), static_cast<int>(d) == chosen)) chosen = static_cast<int>(d);
    ImGui::EndCombo();
}

void plot(const SamplerPoints& points, const Strata& strata, unsigned across, unsigned up) {
    const float side = std::floor(std::min(ImGui::GetContentRegionAvail().x, 300 * ui_scale()));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::InvisibleButton("##sampler", {side, side});
    note_rect("Sampler");
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(at, {at.x + side, at.y + side}, ImGui::GetColorU32(colors::kGround), 2 * ui_scale());
    const ImU32 grid = ImGui::GetColorU32(ImGuiCol_Separator);
    const float least = 3 * ui_scale();  // lines that are nearer to each other would hide the points
    for (unsigned i = 1; i < strata.columns && side / static_cast<float>(strata.columns) > least; ++i) {
        const float x = at.x + side * static_cast<float>(i) / static_cast<float>(strata.columns);
        list.AddLine({x, at.y}, {x, at.y + side}, grid);
    }
    for (unsigned i = 1; i < strata.rows && side / static_cast<float>(strata.rows) > least; ++i) {
        const float y = at.y + side * static_cast<float>(i) / static_cast<float>(strata.rows);
        list.AddLine({at.x, y}, {at.x + side, y}, grid);
    }
    const float radius = (points.samples > 1024 ? 1.0f : 1.8f) * ui_scale();
    for (unsigned s = 0; s < points.samples; ++s)
        list.AddRectFilled({at.x + side * points.at(s, across) - radius, at.y + side * (1 - points.at(s, up)) - radius},
                           {at.x + side * points.at(s, across) + radius, at.y + side * (1 - points.at(s, up)) + radius},
                           ImGui::GetColorU32(colors::kAccent));
}

}  // namespace

void draw_sampler_rows(const SamplerPoints& points, UiState& state) {
    if (points.dimensions < 2 || !folding_section("SAMPLER")) return;
    dimension_row("Across", "the random number that is shown from left to right", points.dimensions, state.points_across);
    dimension_row("Up", "the random number that is shown from below to above", points.dimensions, state.points_up);
    const auto across = static_cast<unsigned>(state.points_across), up = static_cast<unsigned>(state.points_up);
    const Strata strata = strata_of(points, across, up);
    const unsigned cells = strata.columns * strata.rows;
    char text[96];
    std::snprintf(text, sizeof text, "%u of %u, %ux%u", strata.filled, cells, strata.columns, strata.rows);
    row_text("Cells with a point", text,
             "of a grid with as many cells as samples, or fewer. Sobol's points fill all cells of the first two dimensions of "
             "a set");
    plot(points, strata, across, up);
}

}  // namespace clarity::ui
