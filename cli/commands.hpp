// commands.hpp -- the subcommands, one file each, with their options. A command returns the program's exit code and throws
// Error if it fails.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "cli/pose_options.hpp"
#include "import/import.hpp"
#include "plugin/registry.hpp"
#include "tools/check/check.hpp"
#include "view/edit/edit.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

struct SceneOptions {
    std::vector<std::string> files;
    import::ImportOptions import;
};

// Options which render and view share.
struct TraceOptions {
    std::string device;                                         // "": CLARITY_DEVICE; if that is not set, the best device
    std::string accel;                                          // ID[,key=value...]; "": the preset's, or else default_accel()
    std::vector<std::string> sets;                              // key=value, in the order of the command line
    std::vector<std::pair<std::string, std::string>> settings;  // from options of their own; override `sets`
    std::string camera, light;                                  // in the syntax of make_view
    std::string preset;                                         // file; other options override it
};
// The parts of TraceOptions which are checked without a scene, and the edits which need one.
struct TraceWords {
    std::string device;
    Settings settings;
    std::vector<Word> edits;  // of the view, in the order of the command line
    PoseTime pose;            // of the preset
};
// How to import the scene for these edits: with the pictures that they give to materials.
import::ImportOptions import_options(const SceneOptions& scene, const TraceWords& words);
// Throws Error(usage) for an unknown plugin, key or value.
TraceWords read_trace_options(const PluginRegistry& plugins, const TraceOptions& options);

struct RenderOptions {
    SceneOptions scene;
    TraceOptions trace;
    std::string output;  // .png, .exr or .pfm; a run of # is replaced by the frame's number
    std::string frames;  // A-B[/S]; "": one frame with number 1
    PoseOptions pose;
    double fps = 0;              // of the frames; 0: the clip's own
    std::string frames_of;       // K/N: every N-th of these frames, from the K-th on; "": all
    bool skip_existing = false;  // pictures that are there already, with a record that fits, are not rendered again
    // Files from which an interrupted picture goes on; # as in `output`. "": none.
    std::string checkpoint, resume;
    double every_s = 60;       // time between two checkpoints
    bool all_aovs = false;     // --aov all, which is taken out of trace.settings: colours and layers of the first hit
    bool verify = false;       // scene.files are records of frames: they are rendered again and compared
    bool mpi = false;          // this process is one of several that mpirun has started
    double error = 0;          // a picture ends when its estimated error is at most that; 0: after its samples
    double time_budget_s = 0;  // a picture ends after so much time of tracing; 0: after its samples
    unsigned repeat = 1;       // how often each picture is traced, for timing
    std::string crop;          // x,y,width,height: the part of the picture that is rendered; "": all of it
    std::string reference;     // picture to compare with; "": none
    std::string stats_file;    // file for the statistics; "-": stdout; "": none
    bool watch = false;        // render again after each change of a kernel, plugin library or scene file
    bool quiet = false;
};
int run_render(const PluginRegistry& plugins, const RenderOptions& options);
// options.verify: writes a line for each record to stdout. Returns 0 if all pictures are those that were recorded and rendering
// them gives the same pixels again, else 1.
int run_verify(const PluginRegistry& plugins, const RenderOptions& options);

struct ViewCommand {
    SceneOptions scene;
    TraceOptions trace;
    PoseOptions pose;
    std::string key_map;
    std::string reference;  // a picture file; "": none
};
int run_view(const PluginRegistry& plugins, const ViewCommand& options);

// A picture and its reference.
struct CompareCommand {
    std::string test, reference;
    std::string output;  // picture of the signed error, .png; "": none
    bool json = false;
};
int run_compare(const CompareCommand& command);

// Rays by their numbers.
struct TraceCommand {
    SceneOptions scene;
    TraceOptions trace;
    std::string rays_file;  // "-": stdin
    std::string output;     // "-": stdout
    bool any_hit = false;   // only whether something is hit between t_min and t_max
    bool all = false;       // all hits, not only the nearest
    bool count = false;     // how many
    bool work = false;      // what each nearest or any hit takes: nodes, boxes, tests
    unsigned mask = RT_SEEN_BY_ALL;
    bool quiet = false;
};
int run_trace(const PluginRegistry& plugins, const TraceCommand& command);

// A pixel of which to say why it is noisy.
struct WhyCommand {
    SceneOptions scene;
    TraceOptions trace;
    PoseOptions pose;
    double fps = 0;           // for motion blur; 0: the clip's own
    std::string pixel;        // x,y from the top left
    int samples = 0;          // 0: those of `trace`, or a number that suits
    std::string csv_file;     // gets the brightest paths; "": none
    std::string points_file;  // gets the random numbers of all samples
    bool json = false, quiet = false;
};
int run_why(const PluginRegistry& plugins, const WhyCommand& command);

struct CheckCommand {
    std::vector<std::string> what;  // ids and libraries
    check::CheckOptions options;
    std::vector<std::string> scene_files;  // of --scene
    std::string junit_file;
    bool json = false;
};
int run_check(const PluginRegistry& plugins, const CheckCommand& command);

struct NewPluginCommand {
    std::string kind, id, folder;  // folder "": the id, in the working folder
};
int run_new_plugin(const PluginRegistry& plugins, const NewPluginCommand& command);

// Assignments of a course.
struct LabCommand {
    std::string action;              // new, handout, check, grade, night or board
    std::vector<std::string> words;  // a lab, then folders
    std::vector<std::string> only;   // of check: lines
    std::string output, gradescope;  // a folder for records, or a page; Gradescope's file
    std::string device, sdk, work;
    std::vector<std::string> tools;  // folders
    bool autolab = false, counts_only = false;
};
int run_lab(const PluginRegistry& plugins, const LabCommand& command);

struct BenchCommand {
    std::vector<std::string> what;    // suites and scene files
    std::string device;               // comma-separated list, or "all"; "": the best device
    std::vector<std::string> accels;  // ID[,key=value...] each; empty: all structures found
    std::vector<std::string> sets;
    std::vector<std::pair<std::string, std::string>> settings;
    std::string json_file, csv_file, report_folder;
    std::vector<std::string> join_files;  // files of --json of earlier runs
    bool list = false, no_baselines = false, quiet = false;
    double time_limit_s = 0, max_spread = 0.1;
    bool by_processor = false;
    std::vector<std::string> only;
    uint64_t max_triangles = 10'000'000;
    std::vector<unsigned> ranks;    // of suite mpi; empty: the suite's own
    std::vector<unsigned> threads;  // a run with each number of processors; empty: one, with all
    std::string mpirun;             // the same
    std::string reference;          // of suite light: a picture; "": one is rendered
    import::ImportOptions import;
    std::vector<std::string> words;  // as typed: "bench", "cpu", ...
};
int run_bench_command(const PluginRegistry& plugins, const BenchCommand& options);

int run_info(const PluginRegistry& plugins, const SceneOptions& options, const PoseOptions& pose, bool json, bool quiet);

int run_devices(bool json);

// Lists every library that discovery saw: loaded, or the reason why not.
int run_plugins(const PluginRegistry& plugins, bool json);

// Throws Error(import_failed) for a file which does not exist or cannot be read, so that this is known before any work.
void check_scene_files(const std::vector<std::string>& files);
// The same, and throws Error(usage) for an unknown importer, key or value of --importer.
void check_scene(const PluginRegistry& plugins, const SceneOptions& options);

}  // namespace clarity
