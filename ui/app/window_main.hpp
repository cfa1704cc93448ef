// window_main.hpp -- entry point of the window for the command line. It exposes nothing of GL, GLFW or ImGui.
#pragma once
#include "ui/session/view_options.hpp"

namespace clarity::ui {

// Opens the window and returns the program's exit code when it is closed. Throws Error(usage) if there is no display or no
// OpenGL 3.3; the message says how to render without a window. Every later failure is shown as a message in the window.
int ui_main(const ViewOptions& options);

}  // namespace clarity::ui
