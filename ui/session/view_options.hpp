// view_options.hpp -- what the window starts with, as the command line asks for it.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/pictures/float_image.hpp"
#include "import/import.hpp"
#include "plugin/registry.hpp"
#include "scene/motion/pose_time.hpp"
#include "view/edit/edit.hpp"
#include "view/settings/settings.hpp"

namespace clarity::ui {

// Samples a pixel which accumulate while nothing changes, unless the user asks for another number. With one sample, edges are
// jagged.
inline constexpr int kSamplesAtRest = 16;

struct ViewOptions {
    const PluginRegistry* plugins = nullptr;  // must outlive ui_main()
    std::vector<std::string> scenes;          // files that together are one scene; empty: the window opens without a scene
    Settings settings;                        // with accel and accel_params as --accel chose them
    std::string device;                       // as for --device: "", numbers or names, several separated by commas
    std::string camera;                       // as for --camera: "", a name or "ex,ey,ez,tx,ty,tz[,fov_deg]"
    std::string light;                        // as for --light: "" or "x,y,z"
    std::vector<Word> edits;                  // changes to the view of the first scene
    PoseTime pose;                            // of the first scene; a clip alone stands for its begin, and may be a number
    import::ImportOptions import;
    std::shared_ptr<const FloatImage> reference;  // what the picture should be; nullptr: not known
    std::string key_map;                          // "thesis" or "viewer"; "": the remembered one, at first "thesis"
};

}  // namespace clarity::ui
