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

// What CLI11 fills in while a command line is parsed.
struct Parsing {
    CLI::App& app;
    std::shared_ptr<Parsed> parsed;
    CommandLine line;

    // Adds a command, which `run` carries out. prepare: what else is noted where the command is chosen.
    CLI::App& command(const char* name, const char* what, int (*run)(const Parsed&, const PluginRegistry&),
                      void (*prepare)(CommandLine&) = nullptr) {
        CLI::App* sub = app.add_subcommand(name, what);
        sub->callback([this, run, prepare] {
            if (prepare) prepare(line);
            line.command = [parsed = parsed, run](const PluginRegistry& plugins) { return run(*parsed, plugins); };
        });
        return *sub;
    }
};

void without_plugins(CommandLine& line) {
    line.needs_plugins = false;
}

void add_picture_commands(Parsing& parsing) {
    Parsed& p = *parsing.parsed;
    CLI::App& view = parsing.command("view", "Open the window on a scene", [](const Parsed& p, const PluginRegistry& plugins) {
        return run_view(plugins, {p.scene, p.trace, p.render.pose, p.key_map, p.render.reference});
    });
    add_scene(view, p.scene);
    add_trace(view, p.trace);
    add_pose(view, p.render.pose);
    single(view.add_option("--keys", p.key_map, "Key map: thesis or viewer (WASD moves the camera)"))
        ->type_name("MAP")
        ->check(CLI::IsMember({"thesis", "viewer"}));
    single(view.add_option("--reference", p.render.reference,
                           "A picture of what should come out, .pfm, .exr or .png: the RMSE of `path` against it is in the "
                           "Stats tab, and in the captions with Equal time"))
        ->type_name("FILE");

    CLI::App& render =
        parsing.command("render", "Render a scene to a picture file", [](const Parsed& p, const PluginRegistry& plugins) {
            RenderOptions options = p.render;
            options.scene = p.scene, options.trace = p.trace, options.quiet = p.common.quiet;
            return run_render(plugins, options);
        });
    add_scene(render, p.scene)->required();
    add_render(render, p.render);
    add_trace(render, p.trace);
    CLI::Option* aov = render.get_option("--aov");
    aov->description(aov->get_description() + "; all: colours and first hit as layers of one .exr");
}

void add_ray_commands(Parsing& parsing) {
    Parsed& p = *parsing.parsed;
    CLI::App& trace = parsing.command("trace", "Trace rays that are given by their numbers",
                                      [](const Parsed& p, const PluginRegistry& plugins) {
                                          TraceCommand command = p.rays;
                                          command.scene = p.scene, command.trace = p.trace, command.quiet = p.common.quiet;
                                          return run_trace(plugins, command);
                                      });
    add_scene(trace, p.scene)->required();
    add_rays(trace, p.rays);
    add_device(trace, p.trace);
    add_settings(trace, p.trace.settings, p.trace.sets);

    CLI::App& why = parsing.command("why", "Say why a pixel of the tracer `path` is noisy",
                                    [](const Parsed& p, const PluginRegistry& plugins) {
                                        WhyCommand command = p.why;
                                        command.scene = p.scene, command.trace = p.trace, command.pose = p.render.pose;
                                        command.quiet = p.common.quiet;
                                        return run_why(plugins, command);
                                    });
    add_scene(why, p.scene)->required();
    add_why(why, p.why);
    add_pose(why, p.render.pose);
    add_trace(why, p.trace);

    add_compare(parsing.command(
                    "compare", "Say how much a picture differs from a reference",
                    [](const Parsed& p, const PluginRegistry&) { return run_compare(p.compare); }, without_plugins),
                p.compare);
}

void add_tool_commands(Parsing& parsing) {
    Parsed& p = *parsing.parsed;
    add_check(parsing.command("check", "Say whether a plugin is right, in a process that it may crash",
                              [](const Parsed& p, const PluginRegistry& plugins) { return run_check(plugins, p.check); }),
              p.check);
    add_new_plugin(parsing.command(
                       "new-plugin", "Make a folder with a plugin that builds and works, to begin with",
                       [](const Parsed& p, const PluginRegistry& plugins) { return run_new_plugin(plugins, p.fresh); },
                       [](CommandLine& line) { line.refused_plugin_is_fatal = false; }),
                   p.fresh);
    add_lab(parsing.command("lab", "Give, check and grade an assignment of a course",
                            [](const Parsed& p, const PluginRegistry& plugins) { return run_lab(plugins, p.lab); }),
            p.lab);
    add_bench(parsing.command("bench", "Measure: structures, settings, devices and peers on suites or scenes",
                              [](const Parsed& p, const PluginRegistry& plugins) {
                                  BenchCommand command = p.bench;
                                  command.quiet = p.common.quiet;
                                  return run_bench_command(plugins, command);
                              }),
              p.bench);
}

void add_lists(Parsing& parsing) {
    Parsed& p = *parsing.parsed;
    CLI::App& info =
        parsing.command("info", "Show what the importer read from a file", [](const Parsed& p, const PluginRegistry& plugins) {
            return run_info(plugins, p.scene, p.render.pose, p.json, p.common.quiet);
        });
    add_scene(info, p.scene)->required();
    info.add_flag("--json", p.json, "As JSON");
    add_pose(info, p.render.pose);
    parsing
        .command(
            "devices", "List OpenCL devices, best first",
            [](const Parsed& p, const PluginRegistry&) { return run_devices(p.json); }, without_plugins)
        .add_flag("--json", p.json, "As JSON");
    parsing
        .command(
            "plugins", "List every plugin seen, loaded or not, and why not",
            [](const Parsed& p, const PluginRegistry& plugins) { return run_plugins(plugins, p.json); },
            [](CommandLine& line) { line.refused_plugin_is_fatal = false, line.lists_plugins = true; })
        .add_flag("--json", p.json, "As JSON");
}

}  // namespace

CommandLine parse_command_line(int argc, char** argv) {
    CLI::App app("Clarity, a ray-tracing workbench.\n`clarity SCENE...` opens the window, as `clarity view SCENE...` does.",
                 "clarity");
    app.footer(kExitCodes);
    app.set_version_flag("--version", version_text());
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    Parsing parsing{app, std::make_shared<Parsed>(), {}};
    Parsed& p = *parsing.parsed;
    p.bench.words.assign(argv + 1, argv + argc);
    add_picture_commands(parsing);
    add_ray_commands(parsing);
    add_tool_commands(parsing);
    add_lists(parsing);
    for (CLI::App* sub : app.get_subcommands({})) {
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
    parsing.line.common = p.common;
    return parsing.line;
}

}  // namespace clarity
