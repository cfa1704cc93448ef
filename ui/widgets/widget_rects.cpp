#include "ui/widgets/widget_rects.hpp"

#include <imgui.h>

#include <unordered_map>

namespace clarity::ui {
namespace {

struct Place {
    Rect rect;
    int frame = -1;
    bool inside = false;  // not scrolled out of sight
};
std::unordered_map<std::string, Place>& widget_rects() {
    static std::unordered_map<std::string, Place> all;
    return all;
}
std::string wanted;  // label of the rectangle that is to be scrolled into view

}  // namespace

void note_rect(const std::string& label, const Rect& rect) {
    if (label.empty()) return;
    const ImVec2 low = ImGui::GetWindowDrawList()->GetClipRectMin(), high = ImGui::GetWindowDrawList()->GetClipRectMax();
    const float middle = rect.y + rect.height / 2;
    const bool inside = middle > low.y && middle < high.y && rect.x < high.x && rect.x + rect.width > low.x;
    Place& place = widget_rects()[label];
    // If two rectangles of one frame have the same label, the visible one is kept.
    if (inside || !place.inside || place.frame != ImGui::GetFrameCount()) place = {rect, ImGui::GetFrameCount(), inside};
    if (wanted != label) return;
    wanted.clear();
    if (!inside) ImGui::SetScrollHereY(0.5f);
}

void note_rect(const std::string& label) {
    const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
    note_rect(label, {from.x, from.y, to.x - from.x, to.y - from.y});
}

const Rect* drawn_rect(const std::string& label) {
    const auto found = widget_rects().find(label);
    // A script asks between two frames, before ImGui counts the next one.
    if (found == widget_rects().end() || found->second.frame < ImGui::GetFrameCount() - 1) return nullptr;
    if (found->second.inside) return &found->second.rect;
    wanted = label;
    return nullptr;
}

}  // namespace clarity::ui
