// window_main.hpp -- the way into the window for the command line; nothing of GL, GLFW or ImGui shows here.
#pragma once
#include <string>
#include <vector>

#include "import/import.hpp"
#include "plugin/registry.hpp"
#include "render/settings/edit.hpp"
#include "render/settings/settings.hpp"

namespace clarity::ui {

// Samples a pixel that add up while nothing changes, unless the user asks for another number: with one, edges are jagged.
inline constexpr int kSamplesAtRest = 16;

struct ViewOptions {
    const PluginRegistry* plugins = nullptr;  // outlives ui_main
    std::vector<std::string> scenes;          // files that become one scene; empty: the window opens without one
    Settings settings;                        // with accel and accel_params as --accel chose them
    std::string device;                       // as --device: "", numbers, names, several with commas
    std::string camera;                       // as --camera: "", a name or "ex,ey,ez,tx,ty,tz[,fov_deg]"
    std::string light;                        // as --light: "" or "x,y,z"
    std::vector<Word> edits;                  // of the first scene's view
    import::ImportOptions import;
    std::string key_map;  // "thesis", "viewer"; "": as remembered, at first "thesis"
};

// Opens the window and returns when it is closed: the program's exit code. Throws Error(usage) where there is no display or no
// OpenGL 3.3; its message says how to render without a window. Every later failure is a message in the window.
int ui_main(const ViewOptions& options);

}  // namespace clarity::ui
