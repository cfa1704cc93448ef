// commands.hpp -- the subcommands, one file each, and what the command line gives them. Each returns the program's exit code;
// failures are thrown as Error.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "import/import.hpp"
#include "plugin/registry.hpp"
#include "render/settings/edit.hpp"
#include "render/settings/settings.hpp"

namespace clarity {

struct SceneOptions {
    std::vector<std::string> files;
    import::ImportOptions import;
};

// What render and view share.
struct TraceOptions {
    std::string device;                                         // "": CLARITY_DEVICE, else the best
    std::string accel;                                          // ID[,key=value...]; "": the preset's, else default_accel()
    std::vector<std::string> sets;                              // key=value, in the order given
    std::vector<std::pair<std::string, std::string>> settings;  // from options of their own; they win over `sets`
    std::string camera, light;                                  // as make_view reads them
    std::string preset;                                         // file; what is given beside it wins
};
// Words that are checked without a scene, and those that need one. Throws Error(usage) for an unknown plugin, key or value.
struct TraceWords {
    std::string device;
    Settings settings;
    std::vector<Word> edits;  // of the view, in their order
};
TraceWords read_trace_options(const PluginRegistry& plugins, const TraceOptions& options);

struct RenderOptions {
    SceneOptions scene;
    TraceOptions trace;
    std::string output;      // .png, .exr, .pfm; a run of # is the frame's number
    std::string frames;      // A-B[/S]; "": one frame, number 1
    double time_s = 0;       // of the scene
    unsigned repeat = 1;     // frames of each picture, for timing
    std::string stats_file;  // "-": stdout
    bool watch = false;      // again after each save of a kernel or scene file
    bool quiet = false;
};
int run_render(const PluginRegistry& plugins, const RenderOptions& options);

struct ViewCommand {
    SceneOptions scene;
    TraceOptions trace;
    std::string key_map;
};
int run_view(const PluginRegistry& plugins, const ViewCommand& options);

struct BenchCommand {
    std::vector<std::string> what;    // suites and scene files
    std::string device;               // comma list, or "all"; "": the best
    std::vector<std::string> accels;  // ID[,key=value...] each; empty: every one found
    std::vector<std::string> sets;
    std::vector<std::pair<std::string, std::string>> settings;
    std::string json_file, csv_file, report_folder;
    std::vector<std::string> join_files;  // that --json wrote in earlier runs
    bool list = false, no_baselines = false, quiet = false;
    double time_limit_s = 0, max_spread = 0.1;
    std::vector<std::string> only;
    bool breakdown = false;
    uint64_t max_triangles = 10'000'000;
    import::ImportOptions import;
    std::string text;  // of the command line
};
int run_bench_command(const PluginRegistry& plugins, const BenchCommand& options);

int run_info(const PluginRegistry& plugins, const SceneOptions& options, bool json, bool quiet);

int run_devices(bool json);

// Prints every library that discovery saw, loaded or not, and why not.
int run_plugins(const PluginRegistry& plugins, bool json);

// Throws Error(import_failed) for a file that does not exist or cannot be read, before anything is started for it.
void check_scene_files(const std::vector<std::string>& files);

}  // namespace clarity
