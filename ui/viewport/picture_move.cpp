// The parts of PicturePane which show the handles that move, turn and scale the selected instance.
#include <imgui.h>

#include "ui/viewport/picture_pane.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

constexpr ImU32 kShade = IM_COL32(0, 0, 0, 150);
constexpr ImU32 kColors[kMoveHandles] = {IM_COL32(235, 80, 80, 255),   IM_COL32(110, 205, 90, 255), IM_COL32(90, 140, 245, 255),
                                         IM_COL32(240, 240, 240, 255), IM_COL32(235, 80, 80, 255),  IM_COL32(110, 205, 90, 255),
                                         IM_COL32(90, 140, 245, 255),  IM_COL32(240, 240, 240, 255)};
constexpr ImU32 kHot = IM_COL32(255, 205, 70, 255);

ImVec2 point_of(const glm::vec2& p) {
    return {p.x, p.y};
}

void draw_line(ImDrawList& list, const std::vector<glm::vec2>& line, ImU32 color, float width) {
    for (const glm::vec2& p : line) list.PathLineTo(point_of(p));
    list.PathStroke(color, 0, width);
}

void draw_tip(ImDrawList& list, const std::vector<glm::vec2>& arrow, ImU32 color, float size) {
    const glm::vec2 tip = arrow.back(), way = tip - arrow.front();
    const float length = std::sqrt(way.x * way.x + way.y * way.y);
    if (!(length > 0)) return;
    const glm::vec2 along = way * (size / length), across(-along.y * 0.5f, along.x * 0.5f);
    list.AddTriangleFilled(point_of(tip + along), point_of(tip + across), point_of(tip - across), color);
}

}  // namespace

void PicturePane::place_move_handles(Session& session, const UiState& state) {
    move_handles_.reset();
    const auto ready = session.ready();
    if (!state.move_handles || session.selection.instance < 0 || !ready || picture_->job.ready->loaded != ready->loaded) return;
    const auto instance = static_cast<rt_u32>(session.selection.instance);
    const auto middle = session.middle_of(instance);
    if (!middle || session.desired.instances.is_hidden(instance)) return;
    session.prepare_to_move(instance);
    const Projection projection(area_, picture_->job.view.camera);
    move_handles_ = clarity::ui::move_handles(projection, {(*middle)[0], (*middle)[1], (*middle)[2]}, ui_scale());
    if (!move_handles_) return;
    for (int i = 0; i < kMoveHandles; ++i)
        if (const auto place = grab_place(*move_handles_, static_cast<MoveHandle>(i)))
            note_rect(kMoveHandleNames[i], {place->x - 1, place->y - 1, 2, 2});
}

void PicturePane::draw_move_handles(ImDrawList& list) const {
    if (!move_handles_) return;
    const float scale = ui_scale();
    const MoveHandle hot = mouse_.move_handle();
    list.PushClipRect({area_.x, area_.y}, {area_.x + area_.width, area_.y + area_.height}, true);
    for (const bool shade : {true, false})
        for (int i = kMoveHandles; i-- > 0;) {  // rings first: arrows lie over them
            const auto handle = static_cast<MoveHandle>(i);
            const std::vector<glm::vec2>& line = move_handles_->lines[static_cast<size_t>(i)];
            if (line.empty()) continue;
            const ImU32 color = shade ? kShade : handle == hot ? kHot : kColors[i];
            const float more = shade ? 2 * scale : 0;
            if (handle == MoveHandle::view) {
                list.AddCircleFilled(point_of(line.front()), 7 * scale + more / 2, color);
            } else if (handle == MoveHandle::scale) {
                const float half = 6 * scale + more / 2;
                list.AddRectFilled({line.front().x - half, line.front().y - half},
                                   {line.front().x + half, line.front().y + half}, color, 2 * scale);
            } else {
                const bool arrow = handle < MoveHandle::view;
                draw_line(list, line, color, (arrow ? 2.6f : 1.8f) * scale + more);
                if (arrow) draw_tip(list, line, color, 11 * scale + more);
            }
        }
    list.PopClipRect();
}

}  // namespace clarity::ui
