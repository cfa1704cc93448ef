// suite.hpp -- what is to be measured, as data: nothing is loaded or traced here.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "bench/suites/scene_catalog.hpp"
#include "plugin/registry.hpp"

namespace clarity::bench {

// What the command line asks for.
struct BenchRequest {
    std::vector<std::string> suites;                            // as suite_names() has them
    std::vector<std::string> files;                             // scenes instead of a suite's own; without a suite: accel
    std::vector<std::string> accels;                            // ID[,key=value...]; empty: every one found
    std::vector<std::pair<std::string, std::string>> settings;  // key, value: for all cases, where they do not set it
    std::vector<std::string> only;                              // cases whose name has one of these in it; empty: all
    uint64_t max_triangles = 10'000'000;                        // of the suites scale and large
    double time_limit_s = 0;                                    // of everything; 0: what the suites want
    bool baselines = true;
    bool breakdown = false;  // where a frame's time goes; besides the suites
};

struct SuiteScene {
    BenchScene source;
    uint64_t subdivide_to = 0;  // about so many triangles; 0: as it is
};

// One row of a case, on each device.
struct Variant {
    std::string label;
    std::string accel;                                          // ID[,key=value...]
    std::vector<std::pair<std::string, std::string>> settings;  // over those of the request
    bool cpu_only = false;                                      // more lanes than one, or too much private memory
    bool overlapped = false;                                    // moving: each picture is copied while the next is traced
};

enum class Timing { timed, counted_only };

struct BenchCase {
    std::string suite, name;
    std::string measure;  // frame | whitted | primary | shadow | reflection | diffuse | build | dropped | breakdown | picture |
                          // moving
    size_t scene = 0;     // of Suite::scenes
    std::vector<Variant> variants;
    std::vector<std::string> baseline_qualities;  // of peers, where they can trace the scene
    Timing timing = Timing::timed;
    bool mirrors = false;  // breakdown: of the frame that peers render, whatever the scene's materials
};

struct Suite {
    std::vector<SuiteScene> scenes;
    std::vector<BenchCase> cases;    // those of one scene one after the other
    std::vector<std::string> notes;  // what was left out and why
    double time_limit_s = 0;
};

const std::vector<std::string>& suite_names();

// Throws Error(usage) for a suite that there is not.
Suite make_suite(const BenchRequest& request, const SceneCatalog& catalog, const PluginRegistry& plugins);

}  // namespace clarity::bench
