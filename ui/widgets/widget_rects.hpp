// widget_rects.hpp -- the rectangles in which rows, buttons and list entries were drawn. Tests click there.
#pragma once
#include <string>

#include "ui/widgets/rect.hpp"

namespace clarity::ui {

// Notes the rectangle of the last item, or the given one. It counts as visible inside the clip rectangle of the current window.
void note_rect(const std::string& label);
void note_rect(const std::string& label, const Rect& place);
// Returns nullptr if nothing with this label is visible. If it is scrolled out of sight, the next frame scrolls it into view:
// ask again then.
const Rect* drawn_rect(const std::string& label);

}  // namespace clarity::ui
