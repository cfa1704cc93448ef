// record.hpp -- the results of `clarity bench`: one flat record per row. Tables, JSON, CSV and HTML are all made from these.
// docs/bench.md defines every figure.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/statistics.hpp"

namespace clarity::bench {

enum class RowStatus {
    ok,       // complete, with figures
    refused,  // measured, but too unsteady to be believed, or with other hits than the other rows: figures are withheld
    failed,   // an error occurred
    skipped   // not measured, on purpose
};

// Work of the tracer, counted by a separate program. Only active rays count. A packet is the rays which one work-item traces
// side by side, one per lane.
struct Analysis {
    bool present = false;           // false: not counted
    double nodes_per_ray = 0;       // nodes which a ray's packet visits, mean over rays; the ray waits for all of them
    double own_nodes_per_ray = 0;   // nodes among these which the ray itself intersects
    double leaf_tests_per_ray = 0;  // primitives which the ray's packet tests, mean over rays
    double lanes_alive = 0;         // 0..1: share of lanes with a ray that intersects the node, over all node visits
    double warp_alive = 0;          // 0..1, with one lane only: of 32 neighbours, mean of visited nodes divided by the largest
    double bytes_per_ray = 0;       // bytes of nodes and leaves fetched per ray; each packet fetches a node once
    double bytes_shared = 0;   // 0..1: share of node fetches which a packet saves, compared with tracing its rays one by one
    unsigned node_bytes = 0;   // size of a node in bytes
    double boxes_per_ray = 0;  // boxes which the ray's packet tests, mean over rays
    std::string reported;      // "boxes": those of these counts which the structure reports; the host makes the others
};

// Names and milliseconds, in a meaningful order.
using Parts = std::vector<std::pair<std::string, double>>;

// Our speed divided by that of the fastest baseline in the same case.
struct Speedup {
    std::string baseline;    // name of the baseline; "": there was none
    double ratio = 0;        // our speed divided by theirs, above 1 is faster
    double spread = 0;       // measured spread of the ratio; 0: unknown, as in records of earlier versions
    double bytes_ratio = 0;  // our memory divided by theirs, above 1 is more
};

// An animation that was played with one rule for refits and builds.
struct Played {
    double total_ms = 0, update_ms = 0, trace_ms = 0;  // of all frames: refits and builds, and tracing. 0: nothing was played
    unsigned builds = 0;                               // frames whose structure was built
    double worst_cost_ratio = 1;                       // expected cost of a ray (SAH), against that after the last build
    double to_best = 0;                                // total_ms divided by that of the best fixed rule
};

// How the picture of a path tracer gets better with its samples, and what its program takes.
struct LightRun {
    struct Point {
        unsigned samples = 0;
        double ms = 0;  // by the host's clock, of all samples so far
        double rmse = 0, trimmed_rmse = 0, relmse = 0;
    };
    std::string sampler, strategy;  // "": no such picture was measured
    std::string reference;          // file, or what was rendered for it
    double msamples_per_s = 0;      // million paths a second, median wall time
    double slope = 0;               // of log RMSE over log samples; -0.5 of independent samples
    std::vector<Point> points;
    unsigned state_bytes = 0;                // of a path, in one lane; 0: not known
    int registers = -1, spilled_bytes = -1;  // of a work-item; -1: the driver does not tell
};

struct BenchRecord {
    // ---- what was measured
    std::string suite;             // thesis | packets | accel | scale | cpu | devices | mpi | light | quick
    std::string case_name;         // "bunny/primary"; rows of one case were measured interleaved, so that they can be compared
    std::string scene;             // "bunny"
    std::string measure;           // as BenchCase::measure (suite.hpp)
    std::string variant;           // identifies a row within its case and device: "now", "then", "bvh2", "4x4, lanes 16"
    std::string baseline;          // "" for our rows, else "embree packet16 high"
    std::string baseline_quality;  // of its build: "low", "medium", "high", "refit"; not written to files

    // ---- on which device
    std::string device, device_id, driver;  // of a baseline: the host's processor, "host", and "Embree 4.3.3"
    unsigned device_clock_mhz = 0;          // highest clock, as the driver says; 0: unknown
    unsigned threads = 0;                   // compute units of the device; for a baseline its threads

    // ---- settings; of our rows only
    std::string accel, accel_params;  // "bvh2", "max_leaf=4,bins=32"
    std::string tracer;
    int depth = 0;  // generations of rays: the thesis's steps
    int packet_w = 0, packet_h = 0, lanes = 0, ray_slots = 0;
    int width = 0, height = 0;
    uint64_t triangles = 0, primitives = 0;  // placed in the world; primitives: triangles, spheres, polygons, planes

    // ---- outcome
    RowStatus status = RowStatus::ok;
    std::string why;  // unless ok: the reason, and what to do

    // ---- figures; withheld if the row is refused
    std::string clock;      // "processor": time_ms is that of processors, of all threads of this process; "": by a clock
    Summary time_ms;        // by the device's clock: kernels only. build: builder and packing
    Summary wall_ms;        // by the host's clock. frame: from the call to pixels in host memory; else: time of the call
    double processors = 0;  // that this process kept busy during a repetition, median; 0: not known
    double fps = 0;         // frames only: frames a second, from the median wall time
    uint64_t rays_primary = 0, rays_shadow = 0, rays_secondary = 0, rays_dropped = 0;  // per repetition; active rays only
    uint64_t hits = 0;                                                                 // of rows which trace rays
    double mrays_per_s = 0;  // million rays a second, all rays and median device time

    // ---- structure
    double build_ms = 0, pack_ms = 0, compile_ms = 0;
    double mtris_per_s = 0;   // build only: million triangles a second, builder and packing
    double page_faults = -1;  // build only: median; -1: not known. Many if the system takes memory back between builds
    double bytes_per_triangle = 0;
    uint64_t accel_bytes = 0, nodes = 0;
    double sah_cost = 0;  // 0: the structure does not report it

    Speedup speedup;
    Analysis analysis;
    Played animation;                                        // of suite policy
    LightRun light;                                          // of suite light
    std::vector<std::pair<std::string, double>> kernels_ms;  // medians: trace, tone map, read-back

    Parts parts_ms;   // of ranks: they add up to the whole command
    Parts within_ms;  // this and the next: of the breakdown of a frame, which earlier versions measured
    double parts_error_ms = 0;

    unsigned ranks = 0;     // processes of MPI that shared the picture; 0: none did
    double efficiency = 0;  // of ranks: speed-up over the first row, by that of the number of devices; 0: not known

    size_t run = 0;  // 0: BenchReport::run, else joined[run - 1]

    // Name of the variant or the baseline.
    const std::string& name() const { return baseline.empty() ? variant : baseline; }
    uint64_t rays() const { return rays_primary + rays_shadow + rays_secondary; }
};

// Machine, date and conditions of a run; shared by all its rows.
struct BenchRun {
    std::string version;   // of the program
    std::string date;      // ISO 8601, UTC
    std::string command;   // as typed
    std::string host_cpu;  // "AMD EPYC ..."
    unsigned host_threads = 0;
    std::string governor;                              // frequency governor; "": not readable (a virtual machine)
    double clock_mhz_before = 0, clock_mhz_after = 0;  // of the host's processor, mean over its cores, MHz; 0: not readable
    double load_before = 0, load_after = 0;            // load average of the last minute, before and after the run
    double max_spread = 0;                             // rows with a larger spread are refused
    double seconds = 0;                                // duration of the run
};

struct BenchReport {
    BenchRun run;
    std::vector<BenchRun> joined;      // earlier runs, read from files
    std::vector<BenchRecord> records;  // in the order measured
    const BenchRun& run_of(const BenchRecord& record) const { return record.run == 0 ? run : joined.at(record.run - 1); }
    std::vector<std::string> notes;  // what was left out and why, for the user
    bool interrupted = false;        // cancelled by the user; the records are complete rows
    std::string failure;             // reason why the run ended early; "": it did not
};

}  // namespace clarity::bench
