#include "cli/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "base/error.hpp"
#include "cli/command_options.hpp"
#include "cli/help/man_page.hpp"
#include "cli/option_groups.hpp"

namespace clarity {
namespace {

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 failed, 2 usage, 3 no OpenCL device, 4 import failed, 5 kernel build failed, 130 interrupted\n"
    "Environment: CLARITY_DEVICE, CLARITY_PLUGIN_PATH (folders, colon between them), NO_COLOR";

// The options of all commands, as CLI11 fills them in; it must live as long as a command.
struct Parsed {
    CommonOptions common;
    SceneOptions scene;
    TraceOptions trace;
    RenderOptions render;
    BenchCommand bench;
    TraceCommand rays;
    CompareCommand compare;
    WhyCommand why;
    CheckCommand check;
    NewPluginCommand fresh;
    LabCommand lab;
    std::string key_map;
    bool json = false;
};

std::string version_text() {
#ifdef CLARITY_HAVE_UI
    const char* window = "yes";
#else
    const char* window = "no (built without it)";
#endif
    return std::string("clarity ") + CLARITY_VERSION + "\nplugin ABI: " + std::to_string(RT_ABI_VERSION) +
           "\nwindow: " + window;
}

// Inserts the default command: `clarity SCENE...` means `clarity view SCENE...`.
std::vector<std::string> with_command(const CLI::App& app, int argc, char** argv) {
    std::vector<std::string> words(argv + 1, argv + argc);
    const auto is_command = [&](const std::string& word) {
        for (const CLI::App* sub : app.get_subcommands({}))
            if (sub->get_name() == word) return true;
        return word == "-h" || word == "--help" || word == "--version" || word.compare(0, 9, "--help-as") == 0;
    };
    if (words.empty() || !is_command(words.front())) words.insert(words.begin(), "view");
    return words;
}

}  // namespace

CommandLine parse_command_line(int argc, char** argv) {
    const auto parsed = std::make_shared<Parsed>();
    Parsed& p = *parsed;
    CommandLine line;

    CLI::App app("Clarity, a ray-tracing workbench.\n`clarity SCENE...` opens the window, as `clarity view SCENE...` does.",
                 "clarity");
    app.footer(kExitCodes);
    app.set_version_flag("--version", version_text());
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);

    CLI::App* view = app.add_subcommand("view", "Open the window on a scene");
    CLI::App* render = app.add_subcommand("render", "Render a scene to a picture file");
    CLI::App* trace = app.add_subcommand("trace", "Trace rays that are given by their numbers");
    CLI::App* why = app.add_subcommand("why", "Say why a pixel of the tracer `path` is noisy");
    CLI::App* compare = app.add_subcommand("compare", "Say how much a picture differs from a reference");
    CLI::App* check = app.add_subcommand("check", "Say whether a plugin is right, in a process that it may crash");
    CLI::App* fresh = app.add_subcommand("new-plugin", "Make a folder with a plugin that builds and works, to begin with");
    CLI::App* lab = app.add_subcommand("lab", "Give, check and grade an assignment of a course");
    CLI::App* bench = app.add_subcommand("bench", "Measure: structures, settings, devices and peers on suites or scenes");
    CLI::App* info = app.add_subcommand("info", "Show what the importer read from a file");
    CLI::App* devices = app.add_subcommand("devices", "List OpenCL devices, best first");
    CLI::App* plugins = app.add_subcommand("plugins", "List every plugin seen, loaded or not, and why not");

    add_scene(*view, p.scene);
    add_trace(*view, p.trace);
    add_pose(*view, p.render.pose);
    single(view->add_option("--keys", p.key_map, "Key map: thesis or viewer (WASD moves the camera)"))
        ->type_name("MAP")
        ->check(CLI::IsMember({"thesis", "viewer"}));
    single(view->add_option("--reference", p.render.reference,
                            "A picture of what should come out, .pfm, .exr or .png: the RMSE of `path` against it is in the "
                            "Stats tab, and in the captions with Equal time"))
        ->type_name("FILE");
    view->callback([&] {
        line.command = [parsed](const PluginRegistry& registry) {
            return run_view(registry,
                            {parsed->scene, parsed->trace, parsed->render.pose, parsed->key_map, parsed->render.reference});
        };
    });

    add_scene(*render, p.scene)->required();
    add_render(*render, p.render);
    add_trace(*render, p.trace);
    CLI::Option* aov = render->get_option("--aov");
    aov->description(aov->get_description() + "; all: colours and first hit as layers of one .exr");
    render->callback([&] {
        line.command = [parsed](const PluginRegistry& registry) {
            RenderOptions options = parsed->render;
            options.scene = parsed->scene;
            options.trace = parsed->trace;
            options.quiet = parsed->common.quiet;
            return run_render(registry, options);
        };
    });

    add_scene(*trace, p.scene)->required();
    add_rays(*trace, p.rays);
    add_device(*trace, p.trace);
    add_settings(*trace, p.trace.settings, p.trace.sets);
    trace->callback([&] {
        line.command = [parsed](const PluginRegistry& registry) {
            TraceCommand command = parsed->rays;
            command.scene = parsed->scene;
            command.trace = parsed->trace;
            command.quiet = parsed->common.quiet;
            return run_trace(registry, command);
        };
    });

    add_scene(*why, p.scene)->required();
    add_why(*why, p.why);
    add_pose(*why, p.render.pose);
    add_trace(*why, p.trace);
    why->callback([&] {
        line.command = [parsed](const PluginRegistry& registry) {
            WhyCommand command = parsed->why;
            command.scene = parsed->scene;
            command.trace = parsed->trace;
            command.pose = parsed->render.pose;
            command.quiet = parsed->common.quiet;
            return run_why(registry, command);
        };
    });

    add_compare(*compare, p.compare);
    compare->callback([&] {
        line.needs_plugins = false;
        line.command = [parsed](const PluginRegistry&) { return run_compare(parsed->compare); };
    });

    add_check(*check, p.check);
    check->callback(
        [&] { line.command = [parsed](const PluginRegistry& registry) { return run_check(registry, parsed->check); }; });

    add_new_plugin(*fresh, p.fresh);
    fresh->callback([&] {
        line.refused_plugin_is_fatal = false;
        line.command = [parsed](const PluginRegistry& registry) { return run_new_plugin(registry, parsed->fresh); };
    });

    add_lab(*lab, p.lab);
    lab->callback([&] { line.command = [parsed](const PluginRegistry& registry) { return run_lab(registry, parsed->lab); }; });

    add_bench(*bench, p.bench);
    bench->callback([&] {
        parsed->bench.words.assign(argv + 1, argv + argc);
        line.command = [parsed](const PluginRegistry& registry) {
            BenchCommand command = parsed->bench;
            command.quiet = parsed->common.quiet;
            return run_bench_command(registry, command);
        };
    });

    add_scene(*info, p.scene)->required();
    info->add_flag("--json", p.json, "As JSON");
    add_pose(*info, p.render.pose);
    info->callback([&] {
        line.command = [parsed](const PluginRegistry& registry) {
            return run_info(registry, parsed->scene, parsed->render.pose, parsed->json, parsed->common.quiet);
        };
    });

    devices->add_flag("--json", p.json, "As JSON");
    devices->callback([&] {
        line.needs_plugins = false;
        line.command = [parsed](const PluginRegistry&) { return run_devices(parsed->json); };
    });

    plugins->add_flag("--json", p.json, "As JSON");
    plugins->callback([&] {
        line.refused_plugin_is_fatal = false;
        line.lists_plugins = true;
        line.command = [parsed](const PluginRegistry& registry) { return run_plugins(registry, parsed->json); };
    });
    for (CLI::App* sub : {view, render, trace, why, compare, check, fresh, lab, bench, info, devices, plugins}) {
        add_common(*sub, p.common);
        sub->get_formatter()->column_width(34);
        sub->footer(kExitCodes);
    }

    single(app.add_option_function<std::string>(
               "--help-as",
               [&app](const std::string& reader) {
                   throw CLI::CallForVersion(reader == "man" ? man_page(app, CLARITY_VERSION) : bash_completion(app), 0);
               },
               "Print the help of all commands as a page for man, or as completion for bash, and exit"))
        ->type_name("READER")
        ->check(CLI::IsMember({"man", "bash"}));

    std::vector<std::string> words = with_command(app, argc, argv);
    try {
        const std::vector<std::string> reversed(words.rbegin(), words.rend());  // CLI11 expects the arguments in reverse order
        app.parse(std::vector<std::string>(reversed));
    } catch (const CLI::CallForHelp&) {
        std::printf("%s", app.help().c_str());  // of the subcommand, if one was given
        return {};
    } catch (const CLI::CallForVersion& e) {
        std::printf("%s\n", e.what());
        return {};
    } catch (const CLI::ParseError& e) {
        const auto chosen = app.get_subcommands();
        const std::string command = chosen.empty() ? "clarity" : "clarity " + chosen.front()->get_name();
        throw Error(Exit::usage, std::string(e.what()) + " (`" + command + " --help` explains)");
    }
    line.common = p.common;
    return line;
}

}  // namespace clarity
