// clarity view: hands over to the window.
#include "base/error.hpp"
#include "cli/commands.hpp"
#ifdef CLARITY_HAVE_UI
#include "ui/window_main.hpp"
#endif

namespace clarity {

int run_view(const PluginRegistry& plugins, const ViewCommand& command) {
    const TraceWords words = read_trace_options(plugins, command.trace);
    check_scene_files(command.scene.files);
#ifdef CLARITY_HAVE_UI
    ViewOptions options;
    options.plugins = &plugins;
    options.scenes = command.scene.files;
    options.settings = words.settings;
    options.edits = words.edits;
    options.device = words.device;
    options.camera = command.trace.camera;
    options.light = command.trace.light;
    options.import = command.scene.import;
    options.key_map = command.key_map;
    return ui_main(options);
#else
    const std::string scene = command.scene.files.empty() ? "SCENE" : command.scene.files.front();
    throw Error(Exit::usage,
                "this program was built without its window (libimgui-dev, libglfw3-dev or libepoxy-dev was missing); "
                "render a picture with: clarity render " +
                    scene + " -o out.png");
#endif
}

}  // namespace clarity
