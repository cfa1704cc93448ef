#include "frames/preparer.hpp"

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/machine.hpp"
#include "device/cl_errors.hpp"
#include "kernels/program_cache.hpp"
#include "launch/device_scene.hpp"
#include "picture/denoiser.hpp"
#include "picture/film.hpp"
#include "scene/map_edit.hpp"
#include "structures/memory_plan.hpp"
#include "tracers/smoke.hpp"
#include "trial/trial.hpp"
#include "view/settings/accel_choice.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <utility>

namespace clarity {
namespace {

Settings resolve(const Settings& asked, const Device& device, const Scene& scene) {
    Settings s = asked;
    if (s.tracer == "auto") s.tracer = automatic_tracer(device.info(), scene).id;
    resolve_packet(s, device.info());
    return s;
}

// settings: of a structure that is there.
std::shared_ptr<const AccelData> build_new(const PluginRegistry& plugins, const DeviceInfo& info, const Scene& scene,
                                           const Settings& settings, Progress& progress) {
    const rt_plugin& plugin = *plugins.accel(settings.accel);
    const rt_plugin& layout = plugins.layout_of(plugin);
    // The library may have been replaced since the values were chosen.
    const ParameterValues params = fitting_parameters(plugin, settings.accel_params);
    const SceneCounts counts = count_scene(scene);
    const unsigned lanes = settings.lanes > 0 ? static_cast<unsigned>(settings.lanes) : info.preferred_lanes();
    check_fits(plan_memory(counts, scene, *layout.accel), info,
               std::to_string(counts.references) + " primitives in " + plugin.id);
    progress.stage(std::string("building ") + plugin.id);
    const BuildTarget target{&layout, device_for_builders(info, lanes),
                             settings.debug ? BuildPlace::worker : BuildPlace::automatic};
    try {
        return std::make_shared<AccelData>(build_accel(scene, plugin, params, progress, target));
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        throw e.as(Failure::builder);
    }
}

}  // namespace

Preparer::Preparer(const PluginRegistry& plugins, std::shared_ptr<Device> device)
    : plugins_(plugins), info_(device->info()), device_(device), programs_(std::make_unique<ProgramCache>(device)) {}
Preparer::~Preparer() = default;

bool Preparer::needs_reopen() const {
    constexpr unsigned kPrograms = 16;
    const std::lock_guard<std::mutex> lock(mutex_);
    return info_.pocl && programs_ && programs_->compiled() >= kPrograms;
}

DeviceInfo Preparer::close_device() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (last_) {
        auto structure = std::make_shared<Prepared>(*last_);
        structure->on_device.reset();
        structure->program.reset();
        last_ = std::move(structure);
    }
    programs_.reset();
    device_.reset();
    give_free_memory_back();  // PoCL's compiler leaves tens of megabytes in holes
    return info_;
}

void Preparer::open_device(std::shared_ptr<Device> device) {
    const std::lock_guard<std::mutex> lock(mutex_);
    device_ = std::move(device);
    programs_ = std::make_unique<ProgramCache>(device_);
}

bool Preparer::asks_for(const AccelData& accel, const Settings& settings) const {
    Settings resolved = settings;
    const rt_plugin& plugin = resolve_accel(plugins_, kind_of({info_}), resolved);
    return accel.plugin == &plugin && accel.layout == &plugins_.layout_of(plugin) &&
           accel.params == fitting_parameters(plugin, resolved.accel_params);
}

std::shared_ptr<const AccelData> Preparer::build(const std::shared_ptr<const Scene>& scene, const Settings& settings,
                                                 Progress& progress) {
    const std::lock_guard<std::mutex> lock(mutex_);
    Settings resolved = settings;
    resolve_accel(plugins_, kind_of({info_}), resolved);
    return build_or_last(scene, resolved, progress);
}

AccelBuilder Preparer::builder(const Settings& settings) const {
    return [&plugins = plugins_, info = info_, settings](const Scene& scene, Progress& progress) {
        Settings resolved = settings;
        resolve_accel(plugins, kind_of({info}), resolved);
        return build_new(plugins, info, scene, resolved, progress);
    };
}

std::shared_ptr<const AccelData> Preparer::build_or_last(const std::shared_ptr<const Scene>& scene, const Settings& settings,
                                                         Progress& progress) {
    const bool is_same = last_ && (last_->scene == scene || same_geometry(*last_->scene, *scene));
    if (is_same && !last_->is_moved && asks_for(*last_->accel, settings)) return last_->accel;
    // The last scene is no longer in use elsewhere: free it before the next one is built.
    if (last_ && last_->scene != scene && last_.use_count() == 1) last_.reset();
    return build_new(plugins_, info_, *scene, settings, progress);
}

std::shared_ptr<const Prepared> Preparer::prepare(std::shared_ptr<const Scene> scene, const Settings& settings,
                                                  Progress& progress, std::shared_ptr<const AccelData> built,
                                                  const GivenBuffers& moved) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!programs_) throw Error(Exit::no_device, "the device was closed and could not be opened again: choose a device again");
    auto next = std::make_shared<Prepared>();
    next->scene = scene;
    next->settings = resolve(settings, *device_, *scene);
    const rt_plugin* plugin = &resolve_accel(plugins_, kind_of({info_}), next->settings);
    next->layout = make_layout(next->settings, device_->info().traces_packets());
    try {
        next->accel = built ? std::move(built) : build_or_last(scene, next->settings, progress);
        next->is_moved = moved.by_device;
        if (moved.buffers)
            next->on_device = moved.buffers;
        else if (last_ && !last_->is_moved && last_->scene == scene && last_->accel == next->accel)
            next->on_device = last_->on_device;
        if (!next->on_device) {
            progress.stage("uploading the scene");
            const auto start = std::chrono::steady_clock::now();
            next->on_device = std::make_shared<DeviceScene>(*device_, scene, next->accel, progress);
            next->upload_ms = ms_since(start);
        }
        if (progress.cancelled()) throw Cancelled();
        // The film's programs are needed with the first picture. They compile beside that of the tracer, in a worker of their
        // own.
        const KernelRow& row = tracer_of(next->settings).kernel(next->settings, next->layout);
        const bool needs_film = !film_compiled_, needs_denoiser = row.has(kGuides) && !denoiser_compiled_;
        std::future<void> film;
        if (needs_film || needs_denoiser)
            film = std::async(std::launch::async, [&] {
                if (needs_film) {
                    compile_ahead(info_, film_program(), progress);
                    try_film(info_, next->settings, progress);
                }
                if (needs_denoiser) compile_ahead(info_, denoiser_program(), progress);
            });
        progress.stage("compiling kernels");
        progress.report(-1);
        const auto start = std::chrono::steady_clock::now();
        bool fresh = false;
        next->program = tried_program(*programs_, *next, row, progress, &fresh);
        if (fresh) {
            progress.stage(kFirstLaunchStage);
            launch_first(device_, next);
        }
        if (film.valid()) film.get();
        film_compiled_ = true;
        denoiser_compiled_ |= needs_denoiser;
        next->compile_ms = fresh ? ms_since(start) : 0;
        next->compile_cached = !fresh;
    } catch (const cl::Error& e) {
        throw error_on(*device_, std::string("preparing ") + plugin->id, e);
    }
    last_ = next;
    return next;
}

}  // namespace clarity
