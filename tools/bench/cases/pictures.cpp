#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "stand/multi_frame_renderer.hpp"
#include "tools/bench/baselines/whitted.hpp"
#include "tools/bench/cases/case_run.hpp"
#include "tools/bench/cases/entry.hpp"
#include "tools/bench/output/row.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/run/bench.hpp"
#include "tools/bench/run/failure.hpp"
#include "view/settings/accel_choice.hpp"

namespace clarity::bench {
namespace {

constexpr float kSmallDifference = 0.02f;  // tolerance of a pixel if the devices are of different kinds
constexpr double kDifferentPixels = 0.01;  // share of pixels which may exceed it

// The first devices of a run, with their renderer and their row.
struct Team {
    BenchRecord row;
    std::shared_ptr<const MultiPrepared> prepared;
    std::unique_ptr<MultiFrameRenderer> frames;
    std::map<std::string, std::vector<double>>
        times;          // ms of kernels and figures of each device, by name; one entry per repetition
    bool alike = true;  // all devices are of one kind: their pictures must agree exactly
};

std::vector<size_t> team_sizes(size_t all) {
    std::vector<size_t> sizes;
    for (size_t n = 1; n < all; n *= 2) sizes.push_back(n);
    sizes.push_back(all);
    return sizes;
}

// row: describes case, scene and settings; the team's row is a copy of it that also describes devices and structure.
std::unique_ptr<Team> make_team(const MultiPrepared& all, size_t size, const BenchRecord& row) {
    auto team = std::make_unique<Team>();
    team->row = row;
    auto prepared = std::make_shared<MultiPrepared>();
    prepared->parts.assign(all.parts.begin(), all.parts.begin() + static_cast<std::ptrdiff_t>(size));
    Devices devices;
    for (const MultiPrepared::Part& part : prepared->parts) devices.push_back(part.device);
    const std::vector<DeviceInfo> infos = infos_of(devices);
    for (const DeviceInfo& info : infos) team->alike &= info.driver == infos[0].driver && info.cpu == infos[0].cpu;
    describe(team->row, infos[0]);
    team->row.device = devices_name(infos);
    team->row.device_id = device_list_text(infos);
    team->row.threads = 0;
    for (const DeviceInfo& info : infos) team->row.threads += info.compute_units;
    team->frames = std::make_unique<MultiFrameRenderer>(devices);
    team->prepared = std::move(prepared);
    return team;
}

void note_times(Team& team, const FrameStats& stats) {
    for (const KernelTime& kernel : stats.kernels) team.times[kernel.name].push_back(kernel.ms);
    for (const DeviceShare& share : stats.devices) {
        team.times[share.id + " share"].push_back(share.share);
        team.times[share.id + " trace"].push_back(share.device_ms);
        team.times[share.id + " trace, waiting included"].push_back(share.wall_ms);
        team.times[share.id + " launches"].push_back(share.launches);
        team.times[share.id + " tone map"].push_back(share.tone_map_ms);
        team.times[share.id + " read-back"].push_back(share.read_ms);
    }
}

void check_picture(Team& team, const FloatImage& truth, const FloatImage& picture) {
    const double differ = differing_pixels(picture, truth, team.alike ? 0.0f : kSmallDifference);
    if (differ <= (team.alike ? 0.0 : kDifferentPixels)) return;
    char why[160];
    std::snprintf(why, sizeof why, "%.3g %% of its pixels differ from the picture of one device: one of the two is wrong",
                  100 * differ);
    team.row.status = RowStatus::refused;
    team.row.why = why;
}

}  // namespace

std::vector<BenchRecord> measure_pictures(const CaseRun& run) {
    Fixture& fixture = run.fixture;
    const PluginRegistry& plugins = run.plugins;
    Progress& progress = run.progress;
    std::vector<BenchRecord> rows;
    std::vector<DeviceInfo> infos;
    for (size_t i = 0; i < fixture.device_count(); ++i) infos.push_back(fixture.device(i));
    for (const Variant& variant : run.definition.variants) {
        Settings settings = variant_settings(plugins, run.request, variant);
        if (variant.accel.empty()) choose_accel(plugins, default_accel(plugins, device_list_text(infos)), settings);
        BenchRecord row = make_row(run.definition);
        row.accel = settings.accel;
        describe(row, *fixture.scene());
        describe(row, settings);
        std::vector<std::unique_ptr<Team>> teams;
        std::vector<Contender> contenders;
        const auto samples = unsigned(settings.spp);
        try {
            const auto all = fixture.prepare_all(settings, progress);
            for (const size_t size : team_sizes(all->parts.size())) {
                teams.push_back(make_team(*all, size, row));
                Team& team = *teams.back();
                team.row.variant = (variant.label.empty() ? "" : variant.label + ", ") + std::to_string(size) +
                                   (size == 1 ? " device" : " devices");
                describe(team.row, *team.prepared->first());
                contenders.push_back({team.row.variant, [&team, &fixture, &progress, settings, samples] {
                                          const auto begin = std::chrono::steady_clock::now();
                                          FrameStats stats = team.frames->trace(team.prepared, settings, fixture.view(), 0,
                                                                                false, progress, samples);
                                          team.frames->read_display(settings, &stats);
                                          const double wall_ms = ms_since(begin);
                                          note_times(team, stats);
                                          return Sample{stats.device_ms, wall_ms};
                                      }});
            }
            const std::vector<Measured> measured = measure_interleaved(contenders, run.rules, progress);
            FloatImage truth;
            for (size_t i = 0; i < teams.size(); ++i) {
                Team& team = *teams[i];
                set_result(team.row, measured[i]);
                if (team.row.status != RowStatus::ok) continue;
                set_ray_counts(team.row,
                               team.frames->trace(team.prepared, settings, fixture.view(), 0, true, progress, samples));
                set_rates(team.row);
                for (const auto& [name, values] : team.times) team.row.kernels_ms.emplace_back(name, median(values));
                FloatImage picture = team.frames->read_values();
                if (truth.pixels.empty())
                    truth = std::move(picture);
                else
                    check_picture(team, truth, picture);
            }
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& error) {
            row.status = RowStatus::failed;
            row.why = failure_text(error);
            rows.push_back(row);
            continue;
        }
        std::vector<BenchRecord> own;
        for (const auto& team : teams) own.push_back(std::move(team->row));
        compare_with_first(own);
        rows.insert(rows.end(), own.begin(), own.end());
    }
    return rows;
}

}  // namespace clarity::bench
