// fonts.hpp -- DejaVu, as it lies in the program: the window looks the same on a machine without any font.
#pragma once
#include <imgui.h>

namespace clarity::ui {

enum class Face { text, bold, mono };
// Adds a font to the atlas. Owned by the atlas; its data by the program.
ImFont* add_font(ImFontAtlas& atlas, Face face, float pixels);

}  // namespace clarity::ui
