// The parts of PicturePane which draw over the pictures, except for lines of the world: HUD boxes, handles, marks at pixels.
#include <imgui.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "ui/overlay/ray_lines.hpp"
#include "ui/viewport/picture_captions.hpp"
#include "ui/viewport/picture_pane.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

using What = PicturePlace::What;

constexpr ImU32 kHalo = IM_COL32(0, 0, 0, 170), kMark = IM_COL32(255, 255, 255, 235);

ImVec4 color_of(uint32_t rgba) {
    return ImGui::ColorConvertU32ToFloat4(rgba);
}

ImVec2 at(const glm::vec2& place) {
    return {place.x, place.y};
}

// The hue of the light at full brightness.
ImU32 light_color(const rt_light& light) {
    const float most = std::max({light.color[0], light.color[1], light.color[2], 1e-6f});
    return ImGui::GetColorU32(ImVec4(light.color[0] / most, light.color[1] / most, light.color[2] / most, 1));
}

}  // namespace

void PicturePane::draw_hud(ImDrawList& list, const Session& session, VolumeOverlay& overlay) {
    const bool compared = picture_->other.has_value();
    if (compared && places_.front().what == What::difference) {
        // One picture for both sides: both captions over it, the difference in numbers below.
        draw_caption(list, session, 0);
        draw_caption(list, session, 1);
        if (picture_->difference) {
            const std::vector<HudText> lines = {{"Difference", colors::kText, true},
                                                {difference_text(*picture_->difference), colors::kText}};
            const ImVec2 size = card_size(lines, stacks_[0].max_width());
            if (const auto box = take_hud_box(0, Corner::bottom_left, size)) draw_hud_box(list, *box, lines);
        }
    } else {
        for (size_t i = 0; i < places_.size(); ++i) {
            if (compared) draw_caption(list, session, i);
            draw_scale(list, i);
        }
    }
    if (overlay.level())
        for (size_t i = 0; i < places_.size(); ++i) draw_volume_hud(list, i, overlay);
    if (rays_shown_) draw_ray_legend(list);
    draw_part_card(list);
}

void PicturePane::draw_caption(ImDrawList& list, const Session& session, size_t side) {
    const std::vector<HudText> lines = caption_lines(caption_of(session, *picture_, static_cast<unsigned>(side)));
    if (side_by_side()) {  // the caption is above the picture
        const Rect& area = places_[side].area;
        const ImVec2 size = card_size(lines, area.width);
        draw_hud_box(list, {area.x, area.y - size.y - 6, size.x, size.y}, lines);
        return;
    }
    const ImVec2 size = card_size(lines, stacks_[0].max_width());
    if (const auto box = take_hud_box(0, side == 0 ? Corner::top_left : Corner::top_right, size))
        draw_hud_box(list, *box, lines);
}

void PicturePane::draw_scale(ImDrawList& list, size_t place) {
    const PictureSide& side = side_of(places_[place]);
    if (side.scale.map == FalseColorScale::Map::none) return;
    const ImVec2 size = color_bar_size(side.scale, std::min(card_width(place), 300 * ui_scale()));
    const auto box = take_hud_box(place, place == 1 && !side_by_side() ? Corner::bottom_right : Corner::bottom_left, size);
    if (!box) return;
    std::optional<float> value;
    if (const auto hover = mouse_.hover(); hover && side.values && !side.values->pixels.empty())
        value = side.values->pixels[(size_t{hover->y} * side.values->width + hover->x) * side.values->channels];
    draw_color_bar(list, *box, side.scale, value);
}

void PicturePane::draw_volume_hud(ImDrawList& list, size_t place, VolumeOverlay& overlay) {
    const unsigned side = places_[place].side();
    std::string level = level_name(*overlay.level());
    level[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(level[0])));
    const size_t count = overlay.count(side);
    std::string text = count_text(static_cast<double>(count)) + " " + noun(count, "volume");
    if (count == 0) text = overlay.ready() ? "no volumes there" : "walking the tree";
    std::vector<HudText> lines = {{level, color_of(level_color(*overlay.level())), true}, {text, colors::kText, false, true}};
    if (overlay.more(side)) lines.push_back({"the first of more: no more are drawn", colors::kAmber});
    const char* label = overlay.hides_behind() ? "Show those behind" : "Hide those behind";
    const ImVec2 inner = ImGui::CalcTextSize("Show those behind");
    const float pad = hud_padding(), row = place == 0 ? std::round(inner.y + 6 * ui_scale()) : 0;
    ImVec2 size = card_size(lines, card_width(place));
    if (place == 0) size.x = std::max(size.x, inner.x + 2 * pad + 12 * ui_scale());
    size.y += row;
    const auto box = take_hud_box(place, place == 1 && !side_by_side() ? Corner::bottom_right : Corner::bottom_left, size);
    if (!box) return;
    draw_hud_box(list, *box, lines);
    if (place != 0) return;
    ImGui::SetCursorScreenPos({box->x + pad, box->y + box->height - pad - inner.y - 2 * ui_scale()});
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(5 * ui_scale(), 1 * ui_scale()));
    if (ImGui::Button(label)) overlay.hide_behind(!overlay.hides_behind());
    note_rect(label);
    ImGui::PopStyleVar();
    tooltip("What lies behind a surface of the picture is drawn faint, or not at all.");
}

void PicturePane::draw_ray_legend(ImDrawList& list) {
    std::vector<HudText> lines;
    for (const RayKind& kind : ray_kinds()) lines.push_back({kind.name, color_of(kind.color), false, !lines.empty()});
    const ImVec2 size = card_size(lines, std::min(card_width(0), 240 * ui_scale()));
    if (const auto box = take_hud_box(0, Corner::bottom_right, size)) draw_hud_box(list, *box, lines);
}

void PicturePane::draw_wipe(ImDrawList& list) const {
    const Rect& right = places_[1].shown;
    const float scale = ui_scale(), x = right.x, y = right.y + right.height / 2, r = 11 * scale;
    const bool hot = mouse_.wipe_hovered();
    const ImU32 color = hot ? ImGui::GetColorU32(colors::kAccent) : kMark;
    list.AddRectFilled({x - 2 * scale, right.y}, {x + 2 * scale, right.y + right.height}, kHalo);
    list.AddRectFilled({x - 1 * scale, right.y}, {x + 1 * scale, right.y + right.height}, color);
    list.AddCircleFilled({x, y}, r + 1.5f * scale, kHalo);
    list.AddCircleFilled({x, y}, r, color);
    const ImU32 dark = IM_COL32(20, 22, 26, 255);
    for (const float way : {-1.0f, 1.0f})
        list.AddTriangleFilled({x + way * 7 * scale, y}, {x + way * 2.5f * scale, y - 4.5f * scale},
                               {x + way * 2.5f * scale, y + 4.5f * scale}, dark);
}

// The frame of the part that is traced alone, or that is being drawn with the mouse.
void PicturePane::draw_part(ImDrawList& list) const {
    const auto frame = [&](const Rect& r) {
        const ImVec2 a(r.x - 1, r.y - 1), b(r.x + r.width + 1, r.y + r.height + 1);
        list.AddRect(a, b, kHalo, 0, 0, 3 * ui_scale());
        list.AddRect(a, b, ImGui::GetColorU32(colors::kAccent), 0, 0, 1.4f * ui_scale());
    };
    if (const auto& drawn = mouse_.drawn_part()) return frame(*drawn);
    const Settings& traced = picture_->main.settings;
    if (traced.crop.whole_width == 0) return;
    for (const PicturePlace& place : places_) {
        const float x = place.area.width / static_cast<float>(traced.whole_width()),
                    y = place.area.height / static_cast<float>(traced.whole_height());
        list.PushClipRect({place.shown.x, place.shown.y},
                          {place.shown.x + place.shown.width, place.shown.y + place.shown.height}, true);
        frame({place.area.x + x * static_cast<float>(traced.crop.x), place.area.y + y * static_cast<float>(traced.crop.y),
               x * static_cast<float>(traced.width), y * static_cast<float>(traced.height)});
        list.PopClipRect();
    }
}

void PicturePane::draw_part_card(ImDrawList& list) {
    const Settings& traced = picture_->main.settings;
    if (traced.crop.whole_width == 0) return;
    const auto size_text = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
    const std::vector<HudText> lines = {
        {"Part of the picture", colors::kText, true},
        {size_text(traced.width, traced.height) + " of " + size_text(traced.whole_width(), traced.whole_height()) + " pixels",
         colors::kText, false, true},
        {"V: all of it", colors::kDim}};
    if (const auto box = take_hud_box(0, Corner::top_left, card_size(lines, card_width(0)))) draw_hud_box(list, *box, lines);
}

void PicturePane::draw_handles(ImDrawList& list, const Session& session) {
    const float scale = ui_scale();
    const auto& distance = picture_->main.distance;
    list.PushClipRect({area_.x, area_.y}, {area_.x + area_.width, area_.y + area_.height}, true);
    for (const LightHandle& handle : handles_) {
        if (handle.index >= session.desired.lights.size()) continue;
        const DesiredLight& light = session.desired.lights[handle.index];
        const bool chosen = handle.index == session.selected_light;
        const bool hot = mouse_.hovered_light() == static_cast<int>(handle.index);
        unsigned x = 0, y = 0;
        bool behind = false;
        if (handle.kind == LightHandle::Kind::point && distance && !distance->pixels.empty() &&
            pixel_at(area_, handle.place, distance->width, distance->height, x, y))
            behind = handle.distance > distance->pixels[size_t{y} * distance->width + x];
        const float opacity = (behind ? 0.45f : 1.0f) * (light.on ? 1.0f : 0.5f), r = (hot ? 8.0f : 6.5f) * scale;
        const ImU32 color = with_opacity(light_color(light.values), opacity), halo = with_opacity(kHalo, opacity);
        const ImVec2 p = at(handle.place);
        if (handle.kind == LightHandle::Kind::sun) {
            // A sun with rays around its disc, and an arrow in the direction of its light.
            const glm::vec2 middle(area_.x + area_.width / 2, area_.y + area_.height / 2);
            const glm::vec2 way = (middle - handle.place) / std::max(glm::length(middle - handle.place), 1e-3f);
            const ImVec2 tip(p.x + way.x * 30 * scale, p.y + way.y * 30 * scale);
            list.AddLine(p, tip, halo, 4 * scale);
            list.AddLine(p, tip, color, 2 * scale);
            hud_boxes_.push_back({std::min(p.x, tip.x) - 4 * scale, std::min(p.y, tip.y) - 4 * scale,
                                  std::abs(tip.x - p.x) + 8 * scale,
                                  std::abs(tip.y - p.y) + 8 * scale});  // keeps the label away from the arrow
            const glm::vec2 side(-way.y, way.x);
            list.AddTriangleFilled({tip.x + way.x * 7 * scale, tip.y + way.y * 7 * scale},
                                   {tip.x + side.x * 5 * scale, tip.y + side.y * 5 * scale},
                                   {tip.x - side.x * 5 * scale, tip.y - side.y * 5 * scale}, color);
            for (int i = 0; i < 8; ++i) {
                const float a = static_cast<float>(i) * 0.7853982f, c = std::cos(a), s = std::sin(a);
                list.AddLine({p.x + c * r * 1.35f, p.y + s * r * 1.35f}, {p.x + c * r * 1.8f, p.y + s * r * 1.8f}, color,
                             1.5f * scale);
            }
        }
        list.AddCircleFilled(p, r + 1.5f * scale, halo);
        if (handle.kind == LightHandle::Kind::outside)
            list.AddCircle(p, r, color, 0, 2 * scale);
        else
            list.AddCircleFilled(p, r, color);
        if (chosen) list.AddCircle(p, r + 3.5f * scale, ImGui::GetColorU32(colors::kAccent), 0, 2 * scale);
        const std::string name = light.name + (light.on ? "" : " (off)");
        const ImVec2 size = ImGui::CalcTextSize(name.c_str());
        // The label takes the first free place: below, above, right, left.
        const float gap = r + 6 * scale, w = size.x + 6 * scale;
        const Rect places[] = {{p.x - w / 2, p.y + gap, w, size.y},
                               {p.x - w / 2, p.y - gap - size.y, w, size.y},
                               {p.x + gap, p.y - size.y / 2, w, size.y},
                               {p.x - gap - w, p.y - size.y / 2, w, size.y}};
        for (const Rect& label : places) {
            const bool inside = label.x >= area_.x && label.x + label.width <= area_.x + area_.width && label.y >= area_.y &&
                                label.y + label.height <= area_.y + area_.height;
            if (!inside || covered(label)) continue;
            list.AddRectFilled({label.x, label.y}, {label.x + label.width, label.y + label.height}, halo, 3 * scale);
            list.AddText({std::floor(label.x + 3 * scale), std::floor(label.y)},
                         with_opacity(ImGui::GetColorU32(colors::kText), opacity), name.c_str());
            hud_boxes_.push_back(label);
            break;
        }
    }
    list.PopClipRect();
}

// Draws a square around a pixel. Pixels that are too small to see get a larger one.
void PicturePane::draw_pixel_marks(ImDrawList& list, const Session& session, const UiState& state) {
    const auto mark = [&](const PicturePlace& place, float fx, float fy, unsigned columns, ImU32 color) {
        const float half = std::max(place.area.width / static_cast<float>(columns) / 2, 4 * ui_scale());
        const glm::vec2 p(place.area.x + fx * place.area.width, place.area.y + fy * place.area.height);
        if (!place.shown.holds(p.x, p.y)) return;
        list.AddRect({p.x - half - 1, p.y - half - 1}, {p.x + half + 1, p.y + half + 1}, kHalo, 0, 0, 3 * ui_scale());
        list.AddRect({p.x - half - 1, p.y - half - 1}, {p.x + half + 1, p.y + half + 1}, color, 0, 0, 1.4f * ui_scale());
    };
    const auto middle = [](unsigned i, unsigned of) {
        return (static_cast<float>(i) + 0.5f) / static_cast<float>(std::max(of, 1u));
    };
    const auto inspection = session.inspector().latest();
    if (rays_shown_ && inspection && inspection->job.revision == picture_->job.revision) {
        const auto columns = static_cast<unsigned>(inspection->job.settings.width),
                   rows = static_cast<unsigned>(inspection->job.settings.height);
        for (const PicturePlace& place : places_)
            mark(place, middle(inspection->x, columns), middle(inspection->y, rows), columns,
                 ImGui::GetColorU32(colors::kAmber));
    }
    const auto hover = mouse_.hover();
    if (!hover || !state.inspect_hover) return;
    const ByteImage& image = picture_->main.image;
    mark(places_[hover->place], middle(hover->x, image.width), middle(hover->y, image.height), image.width, kMark);
}

}  // namespace clarity::ui
