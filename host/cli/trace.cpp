// clarity trace: traces rays that are given by their numbers, and writes what they hit.
#include <cstdio>
#include <memory>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "render/accel/accel_build.hpp"
#include "render/edit/edit.hpp"
#include "render/settings/accel_choice.hpp"
#include "render/tracers/rays/query_scene.hpp"
#include "render/tracers/rays/ray_queries.hpp"
#include "render/tracers/rays/ray_text.hpp"

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

    const rt_plugin& plugin = *plugins.accel(settings.accel);
    progress.stage(std::string("building ") + plugin.id);
    const ParameterValues params = settings.accel_params.empty() ? default_parameters(plugin) : settings.accel_params;
    const BuildTarget target{&plugins.layout_of(plugin),
                             device_for_builders(device->info(), static_cast<unsigned>(settings.lanes)),
                             settings.debug ? BuildPlace::worker : BuildPlace::automatic};
    const auto accel = std::make_shared<const AccelData>(build_accel(*scene, plugin, params, progress, target));
    const auto prepared = prepare_queries(*device, scene, accel, settings, progress);
    progress.stage("tracing rays");
    RayQueries queries(device);
    std::string text;
    if (command.all || command.count) {
        const AllHits hits = queries.trace_all(*prepared, rays, {command.count, false, command.mask}, progress);
        text = command.count ? counts_text(hits) : all_hits_text(hits);
    } else {
        std::vector<rt_hit> hits;
        RayQuery query;
        query.any_hit = command.any_hit;
        query.mask = command.mask;
        queries.trace(*prepared, RayBlocks(rays, prepared->layout.lanes), query, &hits);
        text = hits_text(hits, command.any_hit);
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
