// suite.hpp -- what is to be measured, as data. Nothing is loaded or traced here.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "plugin/registry.hpp"
#include "tools/bench/scenes/scene_catalog.hpp"

namespace clarity::bench {

// A request of the command line.
struct BenchRequest {
    std::vector<std::string> suites;                               // from suite_names()
    std::vector<std::string> files;                                // scenes which replace a suite's own; without a suite: accel
    std::vector<std::string> accels;                               // ID[,key=value...]; empty: all structures found
    std::vector<std::pair<std::string, std::string>> settings;     // key, value; for all variants which do not set the key
    std::vector<std::string> only;                                 // keeps cases with one of these in their name; empty: all
    std::vector<unsigned> ranks = {1, 2, 4};                       // of suite mpi: numbers of processes
    std::string mpirun = "mpirun --bind-to none --oversubscribe";  // starts them: a program and its options
    uint64_t max_triangles = 10'000'000;                           // largest model of the suites scale and large
    double time_limit_s = 0;                                       // of the whole run; 0: the sum of the suites' own limits
    bool baselines = true;                                         // measure the baselines too
    std::string reference;                                         // of suite light: a picture; "": one is rendered
};

struct SuiteScene {
    BenchScene source;
    uint64_t subdivide_to = 0;  // split to about so many triangles; 0: unchanged
};

// A configuration to measure: one row per device.
struct Variant {
    std::string label;
    std::string accel;                                          // ID[,key=value...]
    std::vector<std::pair<std::string, std::string>> settings;  // override those of the request
    bool cpu_only = false;                                      // needs several lanes, or too much private memory for a GPU
    bool on_device = false;                                     // refits and builds by the device that traces, which is no CPU
    bool refitted = false;        // of rays in a motion: the structure was refitted, not built, for the moved scene
    bool sends_vertices = false;  // of a clip: the host makes the vertices of each pose and sends them
    bool overlapped = false;      // of moving: copy each picture to the host while the next one is traced
    bool cold = false;            // of start: nothing is compiled yet
};

enum class Timing { timed, counted_only };

struct BenchCase {
    std::string suite, name;
    std::string measure;  // frame | whitted | primary | shadow | reflection | diffuse | build | dropped | picture |
                          // ranks | light | start | moving | refit | rebuild | object | clip | play
    size_t scene = 0;     // index into Suite::scenes
    std::vector<Variant> variants;
    std::vector<std::string> baseline_qualities;  // qualities of the baselines; without effect if they cannot trace the scene
    Timing timing = Timing::timed;
    std::string motion;  // of suite moving: see animations.hpp
};

struct Suite {
    std::vector<SuiteScene> scenes;
    std::vector<BenchCase> cases;    // the cases of one scene are adjacent
    std::vector<std::string> notes;  // what was left out, and why
    double time_limit_s = 0;         // sum over the suites
};

const std::vector<std::string>& suite_names();
std::string suite_list();  // the same, for messages

// Throws Error(usage) for an unknown suite, or if no case is left to measure.
Suite make_suite(const BenchRequest& request, const SceneCatalog& catalog, const PluginRegistry& plugins);

}  // namespace clarity::bench
