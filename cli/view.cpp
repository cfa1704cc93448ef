// clarity view: opens the window.
#include <algorithm>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "tools/compare/picture_errors.hpp"
#ifdef CLARITY_HAVE_UI
#include "ui/app/window_main.hpp"
#endif

namespace clarity {
#ifdef CLARITY_HAVE_UI
namespace {

// True if the user chose the number of samples. A preset always chooses it: if it does not name spp, the default of `clarity
// render` holds.
bool names_samples(const TraceOptions& options) {
    const auto named = [](const auto& pair) { return pair.first == "spp"; };
    const auto set = [](const std::string& pair) { return pair.rfind("spp=", 0) == 0; };
    return !options.preset.empty() || std::any_of(options.settings.begin(), options.settings.end(), named) ||
           std::any_of(options.sets.begin(), options.sets.end(), set);
}

}  // namespace
#endif

int run_view(const PluginRegistry& plugins, const ViewCommand& command) {
    const TraceWords words = read_trace_options(plugins, command.trace);
    check_pose(command.pose);
    check_scene(plugins, command.scene);
#ifdef CLARITY_HAVE_UI
    ui::ViewOptions options;
    options.plugins = &plugins;
    options.scenes = command.scene.files;
    options.settings = words.settings;
    if (!names_samples(command.trace)) options.settings.spp = ui::kSamplesAtRest;
    options.edits = words.edits;
    options.device = words.device;
    options.camera = command.trace.camera;
    options.light = command.trace.light;
    options.import = command.scene.import;
    options.pose = command.pose.time_s || !command.pose.clip.empty() ? command.pose : words.pose;
    options.key_map = command.key_map;
    if (!command.reference.empty())
        options.reference = std::make_shared<const FloatImage>(read_reference(command.reference, words.settings));
    return ui::ui_main(options);
#else
    const std::string scene = command.scene.files.empty() ? "SCENE" : command.scene.files.front();
    throw Error(Exit::usage,
                "this program was built without its window (libimgui-dev, libglfw3-dev or libepoxy-dev was missing); "
                "render a picture with: clarity render " +
                    scene + " -o out.png");
#endif
}

}  // namespace clarity
