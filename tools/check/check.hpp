// check.hpp -- is a plugin right? Runs all checks of a library in worker processes, which a faulty plugin may crash.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "plugin/registry.hpp"
#include "scene/scene.hpp"
#include "tools/check/check_job.hpp"

namespace clarity::check {

struct CheckOptions {
    std::vector<std::string> only;  // names of checks, or their beginnings: "hits", "builds.refs"; empty: all
    bool quick = false;
    bool large = false;                // of structures: also scenes of more than 2^20 primitives
    std::string report_folder;         // "": none
    std::string device;                // as for --device
    std::vector<int> lanes;            // with which kernels are compiled; empty: 1, 4, 8 and 16
    std::vector<std::string> samples;  // of importers: files, and folders with files of their extensions
    std::string truth_folder;          // of importers: what others read from the samples; "": none
    bool list = false;                 // runs nothing: each check is a skipped result
    uint64_t seed = 0;                 // of random numbers: see seed.hpp
    double time_limit_s = 0;           // for one plugin; 0: none
    double oclgrind_time_s = 60;       // processor time; it takes seconds to minutes for the same rays, as the kernels are
    bool stop_at_first = false;        // no check begins after one has failed
    // Of structures: the user's own scene, without shapes, and rays through it. Null: none.
    std::shared_ptr<const Scene> scene;
    std::string rays_file;
    // Of builders of topologies: the library is opened by no process but a worker for each build. The record is
    // take_closed_builder()'s.
    std::vector<ClosedBuilder> closed;  // none or one
};

// Whether the names, or beginnings of names, in `only` name a check; all do if there is none.
bool is_wanted(const std::string& check, const std::vector<std::string>& only);

// How the checks of a library ended.
struct CheckEnd {
    bool failed = false;  // a check
    std::string cut;      // why not all checks ran: "--time-limit: 30 s are over"; empty: all did
};

// Checks one library. The host has accepted its plugin. beside: the libraries that it needs: the one that packs and traces
// its topology, or importers of files that samples load. on_result is called from several threads, one at a time, in the order
// in which checks end. Throws Cancelled, and Error if no worker can be started or `only` names nothing.
CheckEnd check_plugin_library(const PluginRecord& record, const std::vector<std::string>& beside, const CheckOptions& options,
                              Progress& progress, const std::function<void(const CheckResult&)>& on_result);

}  // namespace clarity::check
