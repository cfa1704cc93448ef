#include "cli/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "base/error.hpp"
#include "cli/help/bash_completion.hpp"
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
    std::string key_map;
    bool json = false;
};

void add_render(CLI::App& app, RenderOptions& render) {
    single(app.add_option("-o,--output", render.output, "Picture to write: .png, .exr or .pfm; #### is the frame's number"))
        ->type_name("OUT");
    single(app.add_option("--frames", render.frames,
                          "Numbers of the frames to render; frame n shows a scene that moves at n / fps seconds"))
        ->type_name("A-B[/STEP]");
    single(app.add_option("--frames-of", render.frames_of,
                          "Only the K-th of N shares of --frames: every N-th frame, from the K-th on (1/N is the first share)"))
        ->type_name("K/N");
    app.add_flag("--skip-existing", render.skip_existing,
                 "Leave out frames that are there already, whole, with a record (OUT as .json) of the same scene and settings");
    single(app.add_option("--checkpoint", render.checkpoint,
                          "Save the samples so far to this file from time to time, and when the picture is interrupted"))
        ->type_name("FILE");
    single(app.add_option("--every", render.every_s, "Seconds between two checkpoints"))
        ->type_name("S")
        ->check(CLI::Range(0.0, 1e6))
        ->capture_default_str();
    single(app.add_option("--resume", render.resume, "Go on with the samples of a checkpoint, and save further ones there"))
        ->type_name("FILE");
    app.add_flag("--verify", render.verify,
                 "SCENE are records of frames (out_*.json): render these frames again, and compare them with their pictures");
    app.add_flag("--mpi", render.mpi,
                 "Share each picture with the other processes that mpirun has started: mpirun -n 4 clarity render ... --mpi");
    single(app.add_option("--fps", render.fps, "Frames a second; default: those of the clip, else 24"))
        ->type_name("F")
        ->check(CLI::Range(1e-3, 1e6));
    add_pose(app, render.pose);
    single(app.add_option("--repeat", render.repeat, "Trace each frame N times for timing, after one warm-up"))->type_name("N");
    single(app.add_option("--crop", render.crop,
                          "Render this part of the picture of --size: its first pixel from the top left, and its size"))
        ->type_name("X,Y,W,H");
    single(
        app.add_option("--error", render.error,
                       "End each picture of `path` when its estimated error is at most this share of its mean light, 0.01 or "
                       "1%; --spp is then the most samples"))
        ->type_name("E")
        ->transform(percent())
        ->check(CLI::Range(1e-6, 1.0));
    single(app.add_option("--time-budget", render.time_budget_s,
                          "End each picture after this time of tracing, in seconds; --spp is then the most samples"))
        ->type_name("S")
        ->check(CLI::Range(1e-3, 1e7));
    single(app.add_option("--reference", render.reference,
                          "A picture of what should come out, .pfm, .exr or .png: --stats has the errors against it, and how "
                          "they fall with the samples"))
        ->type_name("FILE");
    single(app.add_option("--stats", render.stats_file, "Write a JSON of times, rays and sizes; - is stdout"))
        ->type_name("FILE");
    app.add_flag("--watch", render.watch,
                 "Render again whenever a kernel or a scene file named here is saved or a plugin is built again; Ctrl-C ends, "
                 "with the exit code of the last attempt");
}

void add_rays(CLI::App& app, TraceCommand& command) {
    single(app.add_option("--rays", command.rays_file,
                          "Rays, one a line: origin x y z, t_min, direction x y z, t_max; # begins a comment; - is stdin"))
        ->type_name("FILE")
        ->required();
    single(app.add_option("-o,--output", command.output, "Where to write t, prim, instance, u, v of each hit; - is stdout"))
        ->type_name("HITS")
        ->required();
    CLI::Option* const any =
        app.add_flag("--any", command.any_hit, "Ask only whether something is hit between t_min and t_max: 1 or 0 a ray");
    CLI::Option* const all =
        app.add_flag("--all", command.all,
                     "Write all hits of each ray in their order: the ray's number from 0, then what -o says, a line a hit");
    CLI::Option* const count = app.add_flag("--count", command.count, "Write how many hits each ray has, a number a ray");
    single(app.add_option("--mask", command.mask, "Of the rays: they pass instances whose mask has no bit of it, 0 to 255"))
        ->check(CLI::Range(0u, RT_SEEN_BY_ALL));
    any->excludes(all)->excludes(count);
    all->excludes(count);
}

void add_compare(CLI::App& app, CompareCommand& command) {
    app.add_option("picture", command.test, "The picture: .pfm, .exr or .png")->type_name("A")->required();
    app.add_option("reference", command.reference, "What it should be, of the same size")->type_name("B")->required();
    single(app.add_option("-o,--output", command.output,
                          "Write the signed error as .png: red where A is brighter than B, blue where it is darker"))
        ->type_name("DIFF");
    app.add_flag("--json", command.json, "As JSON");
}

void add_why(CLI::App& app, WhyCommand& why) {
    single(app.add_option("--pixel", why.pixel, "The pixel: its column and row, counted from 0 at the top left"))
        ->type_name("X,Y")
        ->required();
    single(
        app.add_option("--samples", why.samples,
                       "Samples of the pixel that are traced once more, as --spp; default: --spp if that is given, else 1024"))
        ->type_name("K")
        ->check(CLI::Range(2, 65536));
    single(app.add_option("--csv", why.csv_file,
                          "Write the ten brightest paths: each event and each light, with throughput, densities and weight"))
        ->type_name("FILE");
    app.add_flag("--json", why.json, "As JSON");
    single(
        app.add_option("--fps", why.fps, "Frames a second, of which --shutter is a share; default: those of the clip, else 24"))
        ->type_name("F")
        ->check(CLI::Range(1e-3, 1e6));
}

void add_check(CLI::App& app, CheckCommand& command) {
    app.add_option("plugin", command.what,
                   "Ids as `clarity plugins` lists them, libraries, or folders of source, which are built first")
        ->type_name("PLUGIN")
        ->required();
    app.add_option("--only", command.options.only,
                   "Only checks with names that begin with this, such as hits, builds.refs or keys; may be repeated")
        ->type_name("NAME")
        ->allow_extra_args(false);
    app.add_flag("--large", command.options.large,
                 "Of structures: also scenes of more than 2^20 triangles, which takes minutes");
    app.add_option("--lanes", command.options.lanes,
                   "Only kernels of this many lanes; may be repeated; default: 1, 4, 8 and 16")
        ->type_name("N")
        ->allow_extra_args(false)
        ->check(CLI::IsMember({1, 4, 8, 16}));
    app.add_flag("--quick", command.options.quick,
                 "Fewer rays, repetitions and compiled variants: about a minute of processor time, where the long form takes "
                 "several");
    app.add_flag("--list", command.options.list, "Only list the checks: their names and what they try");
    single(app.add_option("--seed", command.options.seed,
                          "Other rays, values and damaged files; 0: those of every run without this option"))
        ->type_name("N")
        ->capture_default_str();
    single(app.add_option("--time-limit", command.options.time_limit_s,
                          "Limit for the checks of one plugin; what is cut is not said to be right"))
        ->type_name("SECONDS")
        ->check(CLI::Range(1.0, 1e6));
    single(app.add_option("--oclgrind-time", command.options.oclgrind_time_s,
                          "Processor time for accesses.oclgrind, which then says that it was cut; default: 60"))
        ->type_name("SECONDS")
        ->check(CLI::Range(1.0, 1e6));
    app.add_flag("--stop-at-first", command.options.stop_at_first, "Begin no check after one has failed");
    app.add_option("--samples", command.options.samples,
                   "Of importers: files to read and to damage, or folders with files of its extensions; may be repeated")
        ->type_name("FILE|DIR")
        ->allow_extra_args(false);
    single(app.add_option("--truth", command.options.truth_folder,
                          "Of importers: a folder of .json files with what other programs read from the samples"))
        ->type_name("DIR");
    CLI::Option* const scene =
        app.add_option("--scene", command.scene_files,
                       "Of structures: only trace the rays of --rays in this scene, and compare all hits "
                       "with those of every primitive tested; may be repeated");
    scene->type_name("FILE")->allow_extra_args(false);
    CLI::Option* const rays =
        single(app.add_option("--rays", command.options.rays_file, "The rays for --scene, as `clarity trace` reads them"));
    rays->type_name("FILE")->needs(scene);
    scene->needs(rays);
    app.add_flag("--json", command.json, "As JSON");
    single(app.add_option("--junit", command.junit_file, "Write the results as JUnit's XML, too"))->type_name("FILE");
    single(app.add_option("--report", command.options.report_folder,
                          "Write the rays with wrong answers into this folder, and a picture of the pixels that differ"))
        ->type_name("DIR");
    single(app.add_option("--device", command.options.device, "The device that traces, as `clarity devices` lists them"))
        ->type_name("D");
}

void add_new_plugin(CLI::App& app, NewPluginCommand& command) {
    app.add_option("kind", command.kind, "accel (an acceleration structure), importer or primitive (a shape)")
        ->type_name("KIND")
        ->required();
    app.add_option("id", command.id, "Its name: lower-case letters, digits and _, a letter first")->type_name("ID")->required();
    app.add_option("folder", command.folder, "The new folder; default: ID in the working folder")->type_name("DIR");
}

void add_bench(CLI::App& app, BenchCommand& bench) {
    app.add_option("what", bench.what,
                   "thesis (its six tests, then and now), packets, accel (every structure and peer), zoo (every structure on "
                   "eight scenes), scale, large (up to 100 M "
                   "triangles), cpu (side by side with the best of each peer), devices (one picture by one, two, ... of "
                   "--device), mpi (one picture by 1, 2, 4 processes that mpirun starts), light (paths of light: errors over "
                   "samples and seconds), moving (refits and rebuilds while "
                   "all vertices move), quick (a minute); or scene files, with a "
                   "suite: instead of its own")
        ->type_name("SUITE|SCENE");
    single(app.add_option("--device", bench.device, "As `clarity devices` lists them; several with commas, or all"))
        ->type_name("D[,D...]");
    app.add_option("--accel", bench.accels, "A structure to compare; may be repeated; default: all which are found")
        ->type_name("ID[,key=value...]")
        ->allow_extra_args(false);
    single(app.add_option("--json", bench.json_file,
                          "Write the records as a JSON list; - writes it to stdout instead of the tables"))
        ->type_name("FILE");
    single(app.add_option("--csv", bench.csv_file, "Write the records as CSV"))->type_name("FILE");
    single(app.add_option("--report", bench.report_folder, "Write a page with charts, index.html, into this folder"))
        ->type_name("DIR");
    app.add_option("--join", bench.join_files, "Add the records of an earlier run (its --json); may be repeated")
        ->type_name("FILE")
        ->allow_extra_args(false);
    app.add_option("--only", bench.only, "Only cases with this in their name, such as bunny/ or /shadow; may be repeated")
        ->type_name("TEXT")
        ->allow_extra_args(false);
    app.add_flag("--list", bench.list, "Only list what would be measured");
    app.add_flag("--no-peers,--no-baselines", bench.no_baselines, "Leave out the baselines: other ray tracers (peers)");
    single(app.add_option("--time-limit", bench.time_limit_s, "Limit for the whole run; default: the limits of the suites"))
        ->type_name("SECONDS")
        ->check(CLI::Range(1.0, 1e6));
    single(app.add_option("--max-spread", bench.max_spread,
                          "Refuse a row if the middle half of its repetitions spreads over more than this share of the median, "
                          "0.1 or 10%"))
        ->type_name("SHARE")
        ->transform(percent())
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    single(app.add_option("--max-triangles", bench.max_triangles, "Largest model of the suites scale, large and zoo"))
        ->type_name("N")
        ->capture_default_str();
    app.add_option("--ranks", bench.ranks, "Of suite mpi: how many processes share a picture, one number a row; default: 1,2,4")
        ->type_name("N[,N...]")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(1u, 4096u));
    single(app.add_option("--mpirun", bench.mpirun,
                          "Of suite mpi: what starts them, with its options; default: mpirun --bind-to none --oversubscribe"))
        ->type_name("COMMAND");
    single(app.add_option(
               "--reference", bench.reference,
               "Of suite light: what should come out, .pfm, .exr or .png; default: a picture of 16 times as many samples"))
        ->type_name("FILE")
        ->check(CLI::ExistingFile);
    app.add_option("--search-path", bench.import.search_paths,
                   "A folder which the scene may read files from, besides its own; may be repeated")
        ->type_name("DIR")
        ->allow_extra_args(false);
    add_settings(app, bench.settings, bench.sets);
}

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
    view->callback([&] {
        line.command = [parsed](const PluginRegistry& registry) {
            return run_view(registry, {parsed->scene, parsed->trace, parsed->render.pose, parsed->key_map});
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

    add_bench(*bench, p.bench);
    bench->callback([&] {
        for (int i = 0; i < argc; ++i) parsed->bench.text += (i > 0 ? " " : "") + std::string(i > 0 ? argv[i] : "clarity");
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
    for (CLI::App* sub : {view, render, trace, why, compare, check, fresh, bench, info, devices, plugins}) {
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
