#include "bench/run/case_runner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <thread>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "bench/baselines/speedup.hpp"
#include "bench/output/row.hpp"
#include "bench/run/analysis.hpp"
#include "bench/run/bench.hpp"
#include "bench/run/breakdown.hpp"
#include "bench/run/failure.hpp"
#include "bench/run/machine.hpp"
#include "bench/run/moving.hpp"
#include "bench/run/pictures.hpp"
#include "render/accel/accel_choice.hpp"
#include "render/queries/ray_blocks.hpp"

namespace clarity::bench {
namespace {

using Clock = std::chrono::steady_clock;

// Beyond so many primitives `linear` is skipped, because one picture would take minutes.
constexpr uint64_t kTryEverything = 4000;
// Share of rays whose hit may differ from the first row's: rays at silhouettes, where rounding decides.
constexpr double kMayDiffer = 1e-3;
// Share of pixels of the baselines' frame which may differ, and from which difference on a pixel counts. The limit is larger
// than for rays, because five generations of mirrors magnify every difference.
constexpr double kPixelsMayDiffer = 1e-2;
constexpr float kPixelMayDiffer = 0.02f;

class CaseRunner {
 public:
    CaseRunner(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request, const BenchCase& c,
               const MeasureRules& rules, Progress& progress)
        : fixture_(fixture), plugins_(plugins), request_(request), case_(c), rules_(rules), progress_(progress) {}

    std::vector<BenchRecord> run() {
        for (const Variant& variant : case_.variants)
            for (size_t device = 0; device < fixture_.device_count(); ++device) {
                if (variant.cpu_only && !fixture_.device(device).cpu) continue;
                if (case_.measure == "moving" && fixture_.device(device).cpu) continue;  // a CPU copies nothing
                if (case_.measure == "build" && device > 0) break;                       // builders run on the host
                add_ours(variant, device);
            }
        if (!case_.baseline_qualities.empty() && fixture_.baseline_threads() > 0 && baselines_cannot(*fixture_.scene()).empty())
            add_baselines();
        if (case_.timing == Timing::timed) measure();
        for (Entry& entry : entries_) guarded(entry, entry.finish);
        std::vector<BenchRecord> rows;
        for (Entry& entry : entries_) {
            derive(entry.row);
            rows.push_back(std::move(entry.row));
        }
        compare_with_baselines(rows);
        if (case_.measure == "moving") compare_with_one_by_one(rows);
        return rows;
    }

 private:
    struct Entry {
        BenchRecord row;
        std::function<Sample()> once;
        std::function<void(BenchRecord&)> finish;  // adds what is counted rather than timed; may be empty
    };

    static void guarded(Entry& entry, const std::function<void(BenchRecord&)>& work) {
        if (entry.row.status != RowStatus::ok || !work) return;
        try {
            work(entry.row);
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& e) {
            // A setting which the device or structure does not support is no failure: the row is skipped.
            const auto* error = dynamic_cast<const Error*>(&e);
            entry.row.status = error && error->code() == Exit::usage ? RowStatus::skipped : RowStatus::failed;
            entry.row.why = failure_text(e);
        }
    }

    BenchRecord make_row() const {
        BenchRecord row;
        row.suite = case_.suite;
        row.case_name = case_.name;
        row.scene = case_.name.substr(0, case_.name.rfind('/'));
        row.measure = case_.measure;
        describe(row, *fixture_.scene());
        return row;
    }

    void add_ours(const Variant& variant, size_t device) {
        entries_.push_back({make_row(), {}, {}});
        Entry& entry = entries_.back();
        Settings settings = variant_settings(plugins_, request_, variant);
        if (variant.accel.empty()) choose_accel(plugins_, default_accel(plugins_, fixture_.device(device).id()), settings);
        const rt_plugin& plugin = *plugins_.accel(settings.accel);
        BenchRecord& row = entry.row;
        row.variant = variant.label;
        row.accel = settings.accel;
        row.accel_params = parameters_text(plugin, settings.accel_params);
        if (case_.measure == "build") {
            describe_host(row, std::thread::hardware_concurrency());
            add_build(entry, plugin, settings);
            return;
        }
        describe(row, fixture_.device(device));
        describe(row, settings);
        if (plugin.accel->ray_cost == RT_RAY_COST_LINEAR && row.primitives > kTryEverything) {
            row.status = RowStatus::skipped;
            row.why = "it tests every primitive, and a picture of " + std::to_string(row.primitives) +
                      " primitives would take minutes";
            return;
        }
        guarded(entry, [&](BenchRecord&) {
            if (case_.measure == "breakdown") {
                const View view = case_.mirrors ? whitted_view(*fixture_.scene(), fixture_.view()) : fixture_.view();
                measure_breakdown(row, fixture_, device, settings, view, rules_, progress_);
                return;
            }
            const Fixture::Held held = fixture_.prepare(device, settings, progress_);
            const Prepared& prepared = *held.prepared;
            describe(row, prepared);
            if (case_.measure == "frame")
                add_frame(entry, settings, held);
            else if (case_.measure == "whitted")
                add_whitted(entry, settings, held);
            else if (case_.measure == "moving")
                add_moving(entry, settings, held, variant.overlapped);
            else if (case_.measure == "dropped")
                entry.finish = [=](BenchRecord& r) { count_rays(r, settings, held, fixture_.view()); };
            else
                add_rays(entry, held);
        });
    }

    void count_rays(BenchRecord& row, const Settings& settings, const Fixture::Held& held, const View& view) {
        const FrameStats stats = held.frames->trace(*held.prepared, settings, view, 0, true, progress_);
        row.rays_primary = stats.primary;
        row.rays_shadow = stats.shadow;
        row.rays_secondary = stats.secondary;
        row.rays_dropped = stats.dropped;
    }

    // Times of a frame's parts in ms by name, one entry per repetition; the record gets the medians.
    using Parts = std::map<std::string, std::vector<double>>;
    static void put_parts(BenchRecord& row, const Parts& parts) {
        for (const auto& [name, ms] : parts) row.kernels_ms.emplace_back(name, median(ms));
    }

    // Renders one frame, from the call to tone-mapped pixels in host memory. Returns its wall time in ms. Appends the kernels'
    // times to `parts`; its "waiting" is the wall time in which the device ran none of them.
    double show_frame(const Settings& settings, const Fixture::Held& held, const View& view, FrameStats& stats, Parts& parts) {
        const auto begin = Clock::now();
        stats = held.frames->trace(*held.prepared, settings, view, 0, false, progress_);
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

    void add_frame(Entry& entry, const Settings& settings, const Fixture::Held& held) {
        const auto parts = std::make_shared<Parts>();
        entry.once = [=] {
            FrameStats stats;
            const double ms = show_frame(settings, held, fixture_.view(), stats, *parts);
            return Sample{stats.device_ms, ms};
        };
        entry.finish = [=](BenchRecord& row) {
            put_parts(row, *parts);
            count_rays(row, settings, held, fixture_.view());
        };
    }

    // The frame which baselines render too. Its times end when the film is complete, as theirs do. Tone mapping and readback
    // are in `parts` only.
    void add_whitted(Entry& entry, const Settings& settings, const Fixture::Held& held) {
        const View view = whitted_view(*fixture_.scene(), fixture_.view());
        whitted_ = whitted_scene(view, settings);
        const auto parts = std::make_shared<Parts>();
        entry.once = [=] {
            FrameStats stats;
            show_frame(settings, held, view, stats, *parts);
            return Sample{stats.device_ms, stats.wall_ms};
        };
        entry.finish = [=](BenchRecord& row) {
            put_parts(row, *parts);
            count_rays(row, settings, held, view);
            compare(row, held.frames->read_values());
        };
    }

    void add_moving(Entry& entry, const Settings& settings, const Fixture::Held& held, bool overlapped) {
        const auto parts = std::make_shared<Parts>();
        entry.once = [=] {
            std::vector<KernelTime> times;
            const Sample take =
                show_moving(*held.frames, *held.prepared, settings, fixture_.view(), overlapped, progress_, &times);
            for (const KernelTime& time : times) (*parts)[time.name].push_back(time.ms);
            return take;
        };
        entry.finish = [=](BenchRecord& row) {
            put_parts(row, *parts);
            uint64_t digest = 0;
            show_moving(*held.frames, *held.prepared, settings, fixture_.view(), overlapped, progress_, nullptr, &digest);
            uint64_t& expected = one_by_one_[same_but_overlapped(row)];
            if (!overlapped) {
                expected = digest;
            } else if (digest != expected) {
                row.status = RowStatus::refused;
                row.why = "its pictures differ from those which are copied one by one: one of the two is wrong";
            }
        };
    }

    void add_rays(Entry& entry, const Fixture::Held& held) {
        const RaySet& set = fixture_.rays(case_.measure, held);
        rays_ = &set;
        const auto lanes = static_cast<unsigned>(held.prepared->settings.lanes);
        std::shared_ptr<const RayBlocks>& packed = packed_[lanes];
        if (!packed) packed = std::make_shared<const RayBlocks>(set.rays, lanes);
        entry.once = [=, &set, blocks = packed] {
            Sample take;
            take.time_ms = held.frames->trace_rays(*held.prepared, *blocks, RayQuery{set.any_hit, false, true});
            const RayTuning tuning = held.frames->ray_tuning();
            take.trial = tuning.trial;
            take.settled = tuning.settled;
            take.way = tuning.variant;
            return take;
        };
        entry.finish = [=, &set](BenchRecord& row) {
            const auto hits = held.frames->trace_rays(*held.prepared, set.rays, RayQuery{set.any_hit, true});
            const rt_accel& accel = *held.prepared->accel->plugin->accel;
            row.analysis = analyze(set.rays, hits, lanes, accel.slot_count > 0 ? accel.slots[0].elem_bytes : 0);
            std::vector<float> distances;
            for (const rt_hit& hit : hits) distances.push_back(hit.t);
            compare(row, set, distances);
        };
        count_active(entry.row, set);
    }

    static void count_active(BenchRecord& row, const RaySet& set) {
        (set.kind == "primary" ? row.rays_primary : set.kind == "shadow" ? row.rays_shadow : row.rays_secondary) = set.active;
    }

    // Refuses a row whose hits differ from the first row's: it does not trace the same scene, so that comparing times would
    // mean nothing. The first row called becomes the reference.
    void compare(BenchRecord& row, const RaySet& set, const std::vector<float>& distances) {
        uint64_t differ = 0;
        for (size_t i = 0; i < set.rays.size(); ++i) {
            if (!is_active(set.rays[i])) continue;
            const float t = distances[i];
            if (std::isfinite(t)) ++row.hits;
            if (reference_.empty()) continue;
            const float other = reference_[i];
            const bool same =
                std::isfinite(t) == std::isfinite(other) && (!std::isfinite(t) || std::fabs(t - other) <= 1e-3f * other);
            if (!same) ++differ;
        }
        if (reference_.empty()) reference_ = distances;
        if (double(differ) <= kMayDiffer * double(set.active)) return;
        row.status = RowStatus::refused;
        row.why = "its answers differ from those of the first row for " + std::to_string(differ) + " of " +
                  std::to_string(set.active) + " rays: one of the two is wrong, `ctest -R conformance` says which";
    }

    // The same for pictures.
    void compare(BenchRecord& row, FloatImage picture) {
        if (reference_picture_.pixels.empty()) {
            reference_picture_ = std::move(picture);
            return;
        }
        const double differ = differing_pixels(picture, reference_picture_, kPixelMayDiffer);
        if (differ <= kPixelsMayDiffer) return;
        char why[160];
        std::snprintf(why, sizeof why,
                      "%.2g %% of its pixels differ from the first row's by more than %g: one of the two is wrong",
                      100 * differ, double(kPixelMayDiffer));
        row.status = RowStatus::refused;
        row.why = why;
    }

    void add_build(Entry& entry, const rt_plugin& plugin, const Settings& settings) {
        const auto last = std::make_shared<BenchRecord>(entry.row);
        entry.once = [=, &plugin] {
            const auto begin = Clock::now();
            const AccelData built = build_accel(*fixture_.scene(), plugin, settings.accel_params, progress_);
            describe(*last, built);
            return Sample{built.build_ms + built.pack_ms, ms_since(begin)};
        };
        entry.finish = [=](BenchRecord& row) {
            row.build_ms = last->build_ms;
            row.pack_ms = last->pack_ms;
            row.accel_bytes = last->accel_bytes;
            row.bytes_per_triangle = last->bytes_per_triangle;
            row.nodes = last->nodes;
            row.sah_cost = last->sah_cost;
        };
    }

    void add_baselines() {
        for (const BaselineKind& kind : baseline_kinds(nullptr)) {
            const auto& wanted = case_.baseline_qualities;
            if (std::find(wanted.begin(), wanted.end(), kind.quality) == wanted.end()) continue;
            if (case_.measure == "build")
                add_baseline_build(kind);
            else if (case_.measure == "whitted")
                add_baseline_frames(kind);
            else
                add_baseline_rays(kind);
        }
    }

    Entry& add_baseline_entry(const std::string& name) {
        entries_.push_back({make_row(), {}, {}});
        BenchRecord& row = entries_.back().row;
        row.baseline = row.variant = name;
        describe_host(row, fixture_.baseline_threads());
        return entries_.back();
    }

    void add_baseline_build(const BaselineKind& kind) {
        Entry& entry = add_baseline_entry(kind.name + " " + kind.quality);
        const auto bytes = std::make_shared<uint64_t>(0);
        const BaselineMesh& mesh = fixture_.baseline_mesh();
        const unsigned threads = fixture_.baseline_threads();
        entry.once = [=, &mesh] {
            const auto begin = Clock::now();
            const auto scene = kind.build(mesh, kind.quality, threads);
            *bytes = scene->bytes();
            return Sample{scene->build_ms(), ms_since(begin)};
        };
        entry.finish = [=](BenchRecord& row) {
            row.build_ms = row.time_ms.median;
            row.accel_bytes = *bytes;
            row.bytes_per_triangle = double(*bytes) / double(row.triangles);
        };
    }

    // Calls `use` with the structure of a baseline. If there is none, adds a failed row with the reason.
    template <class Use>
    void with_baseline(const BaselineKind& kind, const Use& use) {
        try {
            if (case_.measure == "whitted" ? !whitted_ : !rays_)
                throw Error(Exit::failed, "no structure of ours could trace the rays");
            use(fixture_.baseline(kind));
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& e) {
            BenchRecord& row = add_baseline_entry(kind.name + " " + kind.quality).row;
            row.status = RowStatus::failed;
            row.why = failure_text(e);
        }
    }

    static void describe_baseline(BenchRecord& row, const BaselineScene& scene) {
        row.build_ms = scene.build_ms();
        row.accel_bytes = scene.bytes();
    }

    void add_baseline_frames(const BaselineKind& kind) {
        with_baseline(kind, [&](BaselineScene& scene) {
            for (const std::string& mode : scene.frame_modes()) {
                Entry& entry = add_baseline_entry(kind.name + " " + mode + " " + kind.quality);
                const auto film = std::make_shared<BaselineArray<float>>();
                const auto counts = std::make_shared<BaselineRayCounts>();
                entry.row.depth = int(whitted_->generations);
                entry.row.width = int(whitted_->frame.width);
                entry.row.height = int(whitted_->frame.height);
                entry.once = [=, &scene, whitted = *whitted_] {
                    Sample take;
                    take.time_ms = take.wall_ms = scene.frame_ms(mode, whitted, *film, *counts);
                    return take;
                };
                entry.finish = [=, &scene](BenchRecord& row) {
                    describe_baseline(row, scene);
                    row.rays_primary = counts->primary;
                    row.rays_shadow = counts->shadow;
                    row.rays_secondary = counts->secondary;
                    FloatImage picture{unsigned(row.width), unsigned(row.height), 3, {}};
                    for (size_t i = 0; i < film->size(); ++i)
                        if (i % 4 < 3) picture.pixels.push_back((*film)[i]);
                    compare(row, std::move(picture));
                };
            }
        });
    }

    void add_baseline_rays(const BaselineKind& kind) {
        with_baseline(kind, [&](BaselineScene& scene) {
            scene.take_rays(*rays_);
            for (const std::string& mode : scene.modes()) add_baseline_mode(kind, scene, mode);
        });
    }

    void add_baseline_mode(const BaselineKind& kind, BaselineScene& scene, const std::string& mode) {
        Entry& entry = add_baseline_entry(kind.name + " " + mode + " " + kind.quality);
        const RaySet* const set = rays_;
        const auto hits = std::make_shared<BaselineArray<BaselineHit>>(set->rays.size());
        entry.once = [=, &scene] {
            Sample take;
            take.time_ms = scene.trace_ms(mode, *hits);
            return take;
        };
        entry.finish = [=, &scene](BenchRecord& row) {
            describe_baseline(row, scene);
            std::vector<float> distances;
            for (const BaselineHit& hit : *hits) distances.push_back(hit.t);
            compare(row, *set, distances);
        };
        count_active(entry.row, *set);
    }

    void measure() {
        std::vector<Contender> contenders;
        std::vector<Entry*> who;
        for (Entry& entry : entries_) {
            if (entry.row.status != RowStatus::ok || !entry.once) continue;
            contenders.push_back({entry.row.variant, entry.once});
            who.push_back(&entry);
        }
        const std::vector<Measured> measured = measure_interleaved(contenders, rules_, progress_);
        for (size_t i = 0; i < who.size(); ++i) {
            BenchRecord& row = who[i]->row;
            row.status = measured[i].status;
            row.why = measured[i].why;
            row.time_ms = measured[i].time_ms;
            row.wall_ms = measured[i].wall_ms;
        }
    }

    // Compares each overlapped row with the non-overlapped row of the same structure and device.
    static void compare_with_one_by_one(std::vector<BenchRecord>& rows) {
        for (size_t i = 0; i < rows.size(); ++i)
            for (size_t k = 0; k < i; ++k) {
                if (rows[i].status != RowStatus::ok || rows[k].fps <= 0 ||
                    same_but_overlapped(rows[k]) != same_but_overlapped(rows[i]))
                    continue;
                rows[i].speedup = speedup(rows[i], rows[k]);
            }
    }
    static std::string same_but_overlapped(const BenchRecord& row) {
        return row.accel + " " + row.accel_params + " " + row.device_id;
    }

    static void derive(BenchRecord& row) {
        if (row.status != RowStatus::ok) return;
        const double ms = row.time_ms.median;
        if (row.measure != "build" && row.wall_ms.median > 0) row.fps = 1000 / row.wall_ms.median;
        if (row.measure == "build") row.mtris_per_s = ms > 0 ? double(row.triangles) / ms / 1000 : 0;
        if (row.measure != "build" && ms > 0) row.mrays_per_s = double(row.rays()) / ms / 1000;
    }

    Fixture& fixture_;
    const PluginRegistry& plugins_;
    const BenchRequest& request_;
    const BenchCase& case_;
    const MeasureRules& rules_;
    Progress& progress_;
    std::vector<Entry> entries_;
    const RaySet* rays_ = nullptr;                                 // of this case
    std::map<unsigned, std::shared_ptr<const RayBlocks>> packed_;  // the same rays packed for each number of lanes
    std::vector<float> reference_;                                 // hit distances of the first row
    std::optional<WhittedScene> whitted_;                          // set once one of our rows can render it
    FloatImage reference_picture_;                                 // picture of the first row
    std::map<std::string, uint64_t> one_by_one_;  // digests of the non-overlapped pictures, by same_but_overlapped()
};

}  // namespace

std::vector<BenchRecord> run_case(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request,
                                  const BenchCase& c, const MeasureRules& rules, Progress& progress) {
    if (c.measure == "picture") return measure_pictures(fixture, plugins, request, c, rules, progress);
    return CaseRunner(fixture, plugins, request, c, rules, progress).run();
}

}  // namespace clarity::bench
