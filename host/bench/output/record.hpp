// record.hpp -- what `clarity bench` measured: one flat record a row, from which table, JSON, CSV and HTML are all made.
// docs/bench.md defines every figure.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/statistics.hpp"

namespace clarity::bench {

enum class RowStatus {
    ok,
    refused,  // measured, but too unsteady to be believed, or its answers differ from the others': figures are withheld
    failed,   // an error
    skipped   // not measured, on purpose
};

// What the tracer did, by the counting program. Rays are the active ones; a packet is the rays traced side by side, one by one
// lane.
struct Analysis {
    bool present = false;
    double nodes_per_ray = 0;       // that its packet visits, mean over rays: what a ray sits through
    double own_nodes_per_ray = 0;   // of these, those that the ray itself is in
    double leaf_tests_per_ray = 0;  // primitives that its packet tests
    double lanes_alive = 0;         // 0..1: of all lanes at all node visits, those whose ray is in the node
    double warp_alive = 0;          // 0..1, one lane only: of 32 neighbours, mean of nodes visited by the most
    double bytes_per_ray = 0;       // nodes and leaves fetched, each once a packet
    double bytes_shared = 0;        // 0..1: of the nodes that the rays would fetch one by one, what fetching together saves
    unsigned node_bytes = 0;
};

// Names and ms, in an order that means something.
using Parts = std::vector<std::pair<std::string, double>>;

// Ours by the fastest row of a peer in the same case.
struct Speedup {
    std::string baseline;    // which; "": there was none
    double ratio = 0;        // how many times as fast we are
    double spread = 0;       // measured, of the ratio; 0: not known, as in records of earlier versions
    double bytes_ratio = 0;  // of memory, above 1 is more
};

struct BenchRecord {
    // ---- what
    std::string suite;      // thesis | packets | accel | scale | cpu | devices | quick | breakdown
    std::string case_name;  // "bunny/primary"; rows of one case were measured A B A B, so they may be compared
    std::string scene;      // "bunny"
    std::string measure;    // frame | whitted | primary | shadow | reflection | diffuse | build | dropped | breakdown | picture
    std::string variant;    // tells the rows of a case apart on one device: "now", "then", "bvh2", "4x4, 16 lanes"
    std::string baseline;   // "" for ours, else "embree packet16 high"

    // ---- on what
    std::string device, device_id, driver;  // of a peer: the host's processor
    unsigned device_clock_mhz = 0;          // highest, as the driver says; 0: it does not
    unsigned threads = 0;                   // compute units of the device; threads of a peer

    // ---- how; of ours only
    std::string accel, accel_params;  // "bvh2", "max_leaf=4,bins=32"
    std::string tracer;
    int depth = 0;  // generations of rays: the thesis's steps
    int packet_w = 0, packet_h = 0, lanes = 0, ray_slots = 0;
    int width = 0, height = 0;
    uint64_t triangles = 0, primitives = 0;  // placed in the world; primitives: triangles, spheres, polygons, planes

    // ---- how it went
    RowStatus status = RowStatus::ok;
    std::string why;  // unless ok: what is wrong and what to do

    // ---- figures; not refused ones
    Summary time_ms;  // by the device's clock: kernels. build: builder and packing
    Summary wall_ms;  // by the host's: a frame from the call to the pixels in host memory; else as the caller waited
    double fps = 0;   // frames only: of the median wall time
    uint64_t rays_primary = 0, rays_shadow = 0, rays_secondary = 0, rays_dropped = 0;  // of one repetition; active ones
    uint64_t hits = 0;                                                                 // of ray rows
    double mrays_per_s = 0;                                                            // all rays by the median device time

    // ---- the structure
    double build_ms = 0, pack_ms = 0, compile_ms = 0;
    double mtris_per_s = 0;  // build only: triangles by builder and packing
    double bytes_per_triangle = 0;
    uint64_t accel_bytes = 0, nodes = 0;
    double sah_cost = 0;  // 0: the structure does not say

    Speedup speedup;
    Analysis analysis;
    std::vector<std::pair<std::string, double>> kernels_ms;  // medians: trace, tone map, read-back

    Parts parts_ms;             // breakdown: they add up to the frame
    Parts within_ms;            // of these
    double parts_error_ms = 0;  // half of the middle half's width, of the least steady of what they come from

    size_t run = 0;  // 0: BenchReport::run, else joined[run - 1]

    uint64_t rays() const { return rays_primary + rays_shadow + rays_secondary; }
};

// Where and when; the same for all rows of a run.
struct BenchRun {
    std::string version;   // of the program
    std::string date;      // ISO 8601, UTC
    std::string command;   // as typed
    std::string host_cpu;  // "AMD EPYC ..."
    unsigned host_threads = 0;
    std::string governor;                              // "": not readable (a virtual machine)
    double clock_mhz_before = 0, clock_mhz_after = 0;  // of the host's processor, mean over its cores; 0: not readable
    double load_before = 0, load_after = 0;            // load average of the last minute
    double max_spread = 0;                             // above it rows are refused
    double seconds = 0;                                // that the run took
};

struct BenchReport {
    BenchRun run;
    std::vector<BenchRun> joined;      // earlier runs, read from files
    std::vector<BenchRecord> records;  // in the order measured
    const BenchRun& run_of(const BenchRecord& record) const { return record.run == 0 ? run : joined.at(record.run - 1); }
    std::vector<std::string> notes;  // what was left out and why, for a person
    bool interrupted = false;
    std::string failure;  // why the run ended early; "": it did not
};

}  // namespace clarity::bench
