// widget_rects.hpp -- where rows, buttons and entries of lists were drawn: tests click there.
#pragma once
#include <string>

#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

// Of the last item, or of a rectangle; within the clip rectangle of the window that is being drawn.
void note_place(const std::string& label);
void note_place(const std::string& label, const Rect& place);
// nullptr if nothing of that label is on the screen now. What is scrolled out of sight is brought into it by the next frame:
// ask again then.
const Rect* drawn_place(const std::string& label);

}  // namespace clarity::ui
