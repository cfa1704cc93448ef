#include "tools/bench/cases/own_entries.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "device/async_readback.hpp"
#include "launch/prepared.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/run/measure.hpp"

namespace clarity::bench {
namespace {

constexpr unsigned kPictures = 100;
constexpr float kStep = 0.004f;  // radians between two pictures

View turned(View view, unsigned step) {
    const float angle = kStep * float(step), c = std::cos(angle), s = std::sin(angle);
    Camera& camera = view.camera;
    const float x = camera.eye[0] - camera.target[0], z = camera.eye[2] - camera.target[2];
    camera.eye[0] = camera.target[0] + c * x + s * z;
    camera.eye[2] = camera.target[2] - s * x + c * z;
    return view;
}

// A digest of all bytes of a picture, which costs little compared with tracing it.
void add_bytes(uint64_t& digest, const SharedBytes& bytes) {
    for (size_t i = 0; i + 8 <= bytes.size(); i += 8) {
        uint64_t word;
        std::memcpy(&word, bytes.data() + i, sizeof word);
        digest = (digest ^ word) * 0x9E3779B97F4A7C15u;
    }
}

// Renders 100 pictures of a camera which circles its target. Each picture is copied to the host. Returns mean times per
// picture. overlapped: copies each picture while the next one is traced, else before. digest: receives a digest of all
// pictures' bytes. parts: receives the kernels' times of each picture.
Sample show_moving(const Fixture::Held& held, const Settings& settings, const View& view, bool overlapped, Progress& progress,
                   std::vector<KernelTime>* parts = nullptr, uint64_t* digest = nullptr) {
    Sample sample;
    MultiFrameRenderer& frames = *held.frames;
    AsyncReadback pending;
    FrameStats pending_stats;
    const auto show = [&](const ByteImage& picture, const FrameStats& stats) {
        if (parts) parts->insert(parts->end(), stats.kernels.begin(), stats.kernels.end());
        if (digest) add_bytes(*digest, picture.pixels);
    };
    const auto show_pending = [&] {
        if (pending) show(pending.wait(&pending_stats.kernels), pending_stats);
    };
    const auto begin = std::chrono::steady_clock::now();
    for (unsigned i = 0; i < kPictures; ++i) {
        if (progress.cancelled()) throw Cancelled();
        FrameStats stats = frames.trace(held.prepared, settings, turned(view, i), 0, false, progress, 1, show_pending);
        sample.time_ms += stats.device_ms / kPictures;
        if (overlapped) {
            pending = frames.begin_display(settings);
            pending_stats = std::move(stats);
        } else {
            show(frames.read_display(settings, &stats), stats);
        }
    }
    show_pending();
    sample.wall_ms = ms_since(begin) / kPictures;
    return sample;
}

// Times of a frame's parts in ms by name, one entry per repetition; the record gets the medians.
using PartTimes = std::map<std::string, std::vector<double>>;

void set_medians(BenchRecord& row, const PartTimes& parts) {
    for (const auto& [name, ms] : parts) row.kernels_ms.emplace_back(name, median(ms));
}

// Renders one frame, from the call to tone-mapped pixels in host memory. Returns its wall time in ms. Appends the kernels'
// times to `parts`; its "waiting" is the wall time in which the device ran none of them.
double show_frame(CaseState& state, const Settings& settings, const Fixture::Held& held, const View& view, FrameStats& stats,
                  PartTimes& parts) {
    const auto begin = std::chrono::steady_clock::now();
    stats = held.frames->trace(held.prepared, settings, view, 0, false, state.progress);
    held.frames->read_display(settings, &stats);
    const double ms = ms_since(begin);
    double busy = 0;
    for (const KernelTime& kernel : stats.kernels) {
        parts[kernel.name].push_back(kernel.ms);
        busy += kernel.ms;
    }
    parts["waiting"].push_back(std::max(ms - busy, 0.0));
    return ms;
}

// Of this process: pages that it got without reading a file.
long minor_page_faults() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_minflt;
}

constexpr size_t kWarp = 32;

double ratio(double a, double b) {
    return b > 0 ? a / b : 0;
}

// Share of a warp's time in which its rays do work: all rays of a warp wait for the ray which visits most nodes.
double warp_alive(const std::vector<rt_ray>& rays, const std::vector<rt_hit>& hits) {
    double visited = 0, waited = 0;
    for (size_t first = 0; first < rays.size(); first += kWarp) {
        rt_u32 most = 0;
        for (size_t i = first; i < std::min(first + kWarp, rays.size()); ++i) {
            if (!is_active(rays[i])) continue;
            visited += hits[i].steps;
            most = std::max(most, hits[i].steps);
        }
        waited += double(kWarp) * most;
    }
    return ratio(visited, waited);
}

}  // namespace

void add_build(Entry& entry, std::function<AccelData()> build) {
    const auto last = std::make_shared<BenchRecord>(entry.row);
    const auto faults = std::make_shared<std::vector<double>>();
    entry.once = [last, faults, build = std::move(build)] {
        const long before = minor_page_faults();
        const auto begin = std::chrono::steady_clock::now();
        const double used_ms = processor_ms();
        const AccelData built = build();
        const double processors_ms = processor_ms() - used_ms;
        faults->push_back(double(minor_page_faults() - before));
        describe(*last, built);
        return Sample{built.build_ms + built.pack_ms, ms_since(begin), processors_ms};
    };
    entry.finish = [=](BenchRecord& row) {
        row.page_faults = faults->empty() ? -1 : summarize(*faults).median;
        row.build_ms = last->build_ms;
        row.pack_ms = last->pack_ms;
        row.accel_bytes = last->accel_bytes;
        row.bytes_per_triangle = last->bytes_per_triangle;
        row.nodes = last->nodes;
        row.sah_cost = last->sah_cost;
    };
}

void time_rays(CaseState& state, Entry& entry, const Fixture::Held& held, const RaySet& set) {
    const auto lanes = static_cast<unsigned>(held.prepared->first()->settings.lanes);
    std::shared_ptr<const RayBlocks>& packed = state.packed[lanes];
    if (!packed) packed = std::make_shared<const RayBlocks>(set.rays, lanes);
    const bool cpu = held.prepared->first()->layout.cpu;
    entry.once = [=, &set, blocks = packed] {
        Sample sample;
        sample.time_ms = held.queries->trace(*held.prepared->first(), *blocks, RayQuery{set.any_hit, false, true});
        const RayTuning tuning = held.queries->tuning();
        if (cpu) sample.processor_ms = tuning.processor_ms;
        sample.trial = tuning.trial;
        sample.settled = tuning.settled;
        sample.variant = tuning.variant;
        return sample;
    };
    set_ray_counts(entry.row, set);
}

void add_rays(CaseState& state, Entry& entry, const Fixture::Held& held) {
    const RaySet& set = state.fixture.rays(state.definition.measure, held);
    state.rays = &set;
    time_rays(state, entry, held, set);
    entry.finish = [=, &set, &state](BenchRecord& row) {
        std::vector<RayWork> work;
        RayQuery query{set.any_hit, true};
        query.work = &work;
        const auto hits = held.queries->trace(*held.prepared->first(), set.rays, query);
        const auto lanes = static_cast<unsigned>(held.prepared->first()->settings.lanes);
        const rt_accel& accel = *held.prepared->first()->accel->layout->accel;
        row.analysis = analyze(set.rays, hits, work, lanes, accel.slot_count > 0 ? accel.slots[0].elem_bytes : 0);
        std::vector<float> distances;
        for (const rt_hit& hit : hits) distances.push_back(hit.t);
        state.agreement.check_hits(row, set, distances);
    };
}

void set_ray_counts(BenchRecord& row, const RaySet& set) {
    (set.kind == "primary" ? row.rays_primary : set.kind == "shadow" ? row.rays_shadow : row.rays_secondary) = set.active;
}

void add_frame(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held) {
    const auto parts = std::make_shared<PartTimes>();
    entry.once = [=, &state] {
        FrameStats stats;
        const double ms = show_frame(state, settings, held, state.fixture.view(), stats, *parts);
        return Sample{stats.device_ms, ms};
    };
    entry.finish = [=, &state](BenchRecord& row) {
        set_medians(row, *parts);
        count_rays(state, row, settings, held, state.fixture.view());
    };
}

void add_whitted(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held) {
    const View view = whitted_view(*state.fixture.scene(), state.fixture.view());
    state.whitted = whitted_scene(view, settings);
    const auto parts = std::make_shared<PartTimes>();
    entry.once = [=, &state] {
        FrameStats stats;
        show_frame(state, settings, held, view, stats, *parts);
        return Sample{stats.device_ms, stats.wall_ms};
    };
    entry.finish = [=, &state](BenchRecord& row) {
        set_medians(row, *parts);
        count_rays(state, row, settings, held, view);
        state.agreement.check_picture(row, held.frames->read_values());
    };
}

void add_moving(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held, bool overlapped) {
    const auto parts = std::make_shared<PartTimes>();
    entry.once = [=, &state] {
        std::vector<KernelTime> times;
        const Sample sample = show_moving(held, settings, state.fixture.view(), overlapped, state.progress, &times);
        for (const KernelTime& time : times) (*parts)[time.name].push_back(time.ms);
        return sample;
    };
    entry.finish = [=, &state](BenchRecord& row) {
        set_medians(row, *parts);
        uint64_t digest = 0;
        show_moving(held, settings, state.fixture.view(), overlapped, state.progress, nullptr, &digest);
        state.agreement.check_sequence(row, digest, overlapped);
    };
}

void count_rays(CaseState& state, BenchRecord& row, const Settings& settings, const Fixture::Held& held, const View& view) {
    set_ray_counts(row, held.frames->trace(held.prepared, settings, view, 0, true, state.progress));
}

void compare_with_one_by_one(std::vector<BenchRecord>& rows) {
    for (size_t i = 0; i < rows.size(); ++i)
        for (size_t k = 0; k < i; ++k) {
            if (rows[i].status != RowStatus::ok || rows[k].fps <= 0 ||
                structure_and_device(rows[k]) != structure_and_device(rows[i]))
                continue;
            rows[i].speedup = speedup(rows[i], rows[k]);
        }
}

Analysis analyze(const std::vector<rt_ray>& rays, const std::vector<rt_hit>& hits, const std::vector<RayWork>& work,
                 unsigned lanes, unsigned node_bytes) {
    double active = 0, nodes = 0, leaves = 0, own = 0, nodes_sat = 0, leaves_sat = 0, boxes_sat = 0;
    RayWork reported{};  // not 0: a packet has some
    for (size_t first = 0; first < rays.size(); first += lanes) {
        double in_packet = 0;
        for (size_t i = first; i < std::min(first + lanes, rays.size()); ++i) in_packet += is_active(rays[i]);
        if (in_packet == 0) continue;
        const rt_hit& counted = hits[first];  // each ray holds the sums of its packet
        active += in_packet;
        nodes += counted.steps;
        leaves += counted.leaf_tests;
        own += counted.lane_steps;
        nodes_sat += in_packet * counted.steps;
        leaves_sat += in_packet * counted.leaf_tests;
        const RayWork& more = work[first];
        boxes_sat += in_packet * (double(more.boxes) + more.own_boxes);
        reported.own_steps |= more.own_steps;
        reported.own_boxes |= more.own_boxes;
        reported.own_tests |= more.own_tests;
    }
    Analysis a;
    a.present = active > 0;
    a.node_bytes = node_bytes;
    a.nodes_per_ray = ratio(nodes_sat, active);
    a.own_nodes_per_ray = ratio(own, active);
    a.leaf_tests_per_ray = ratio(leaves_sat, active);
    a.boxes_per_ray = ratio(boxes_sat, active);
    for (const auto& [count, name] :
         {std::pair(reported.own_steps, "nodes"), {reported.own_boxes, "boxes"}, {reported.own_tests, "tests"}})
        if (count != 0) a.reported += (a.reported.empty() ? "" : ", ") + std::string(name);
    a.lanes_alive = ratio(own, nodes * lanes);
    if (lanes == 1) a.warp_alive = warp_alive(rays, hits);
    a.bytes_per_ray = ratio(nodes * node_bytes + leaves * sizeof(rt_packed_prim), active);
    a.bytes_shared = own > 0 ? std::max(0.0, 1 - nodes / own) : 0;
    return a;
}

}  // namespace clarity::bench
