// clarity trace: traces rays that are given by their numbers, and writes what they hit.
#include <cstdio>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "launch/prepared.hpp"
#include "stand/multi_preparer.hpp"
#include "stand/ray_text.hpp"
#include "tracers/rays/ray_queries.hpp"
#include "view/edit/edit.hpp"
#include "view/settings/accel_choice.hpp"

namespace clarity {
namespace {

Settings settings_of(const PluginRegistry& plugins, const TraceOptions& options, std::string& device) {
    TraceWords words = read_trace_options(plugins, options);
    if (!words.edits.empty())
        throw Error(Exit::usage, "--set " + words.edits.front().key +
                                     "=...: `clarity trace` has no camera, lights or materials; give settings only");
    device = words.device;
    return words.settings;
}

// A structure's own counts are marked, because they may be wrong.
void report_own_counts(const std::vector<RayWork>& work, const std::string& accel) {
    uint64_t steps = 0, boxes = 0, tests = 0;
    for (const RayWork& ray : work) steps += ray.own_steps, boxes += ray.own_boxes, tests += ray.own_tests;
    std::string which;
    for (const auto& [count, name] : {std::pair(steps, "nodes"), {boxes, "boxes"}})
        if (count > 0) which += (which.empty() ? "" : " and ") + std::string(name);
    if (!which.empty())
        log(LogLevel::info, "--work: " + which + " are as `" + accel + "` reports them: it does not use the host's tests");
    if (tests > 0)
        log(LogLevel::info, "--work: `" + accel + "` tests primitives by itself, too, and reports " + std::to_string(tests) +
                                " tests; they are left out");
}

}  // namespace

int run_trace(const PluginRegistry& plugins, const TraceCommand& command) {
    if (command.output != "-") check_writable(command.output);
    std::string device_text;
    const Settings settings = settings_of(plugins, command.trace, device_text);
    RayOrigins origins;
    std::vector<rt_ray> rays = read_rays(command.rays_file, &origins);
    if (rays.empty()) log(LogLevel::warning, command.rays_file + ": there is no ray in it");
    check_scene(plugins, command.scene);
    ProgressBar progress(command.quiet);
    const CancelOnSignal cancel(progress);
    const auto device = std::make_shared<Device>(choose_device(device_text));
    const auto scene = std::make_shared<const Scene>(
        with_scene_edits(import::import_scene(plugins, command.scene.files, command.scene.import, progress)));

    for (size_t i = 0; scene->origin != std::array<double, 3>{} && i < rays.size(); ++i)
        for (int k = 0; k < 3; ++k) rays[i].origin[k] = static_cast<float>(origins[i][k] - scene->origin[k]);
    origins = {};

    const auto accel = MultiPreparer(plugins, {device}).build(scene, settings, progress);
    const auto prepared = prepare_queries(*device, scene, accel, settings, progress);
    progress.stage("tracing rays");
    RayQueries queries(device);
    std::string text;
    if (command.all || command.count) {
        const AllHits hits = queries.trace_all(*prepared, rays, {command.count, false, command.mask}, progress);
        text = command.count ? counts_text(hits) : all_hits_text(hits);
    } else {
        std::vector<rt_hit> hits;
        std::vector<RayWork> work;
        RayQuery query;
        query.any_hit = command.any_hit;
        query.count = command.work;
        query.work = &work;
        query.mask = command.mask;
        queries.trace(*prepared, RayBlocks(rays, prepared->layout.lanes), query, &hits);
        text = hits_text(hits, command.any_hit, work);
        report_own_counts(work, settings.accel);
    }
    progress.clear();
    if (progress.cancelled()) throw Cancelled();

    if (command.output == "-")
        std::fwrite(text.data(), 1, text.size(), stdout);
    else
        write_text_file(command.output, text);
    return static_cast<int>(Exit::done);
}

}  // namespace clarity
