#include "render/trial/trial_job.hpp"

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "render/trial/worker/trial_runs.hpp"
#include "scene/surface_models.hpp"
#include "worker/child.hpp"

namespace clarity {
namespace {

// Mesa's llvmpipe compiles a kernel when it is first launched with a size of work-group. Seconds; measured 20 to 90.
constexpr double kLlvmpipeCompiles_s = 150;

// Returns why there is no trial; nothing: the kernels have passed. Throws Error if they have not.
Problem try_kernels(const TrialJob& job) {
    std::vector<std::string> libraries;
    for (const auto& [loaded, original] : job.libraries) {
        if (loaded != original) note_private_copy(loaded, original);
        libraries.push_back(loaded);
    }
    number_surface_models(job.surfaces);
    const PluginRegistry plugins = PluginRegistry::of(libraries);
    std::shared_ptr<Device> device;
    try {
        device = std::make_shared<Device>(choose_device(job.device));
    } catch (const Error& e) {
        return e.what();
    }
    if (device->info().name != job.device_name) return "device " + job.device + " is " + device->info().name + " here";
    const TrialSteps steps = [more_s = device->info().llvmpipe ? kLlvmpipeCompiles_s : 0](
                                 const std::string& step, double limit_s) { worker::say_step(step, limit_s + more_s); };
    return job.kernels == kFilmKernels ? try_film_kernels(device, steps) : try_on_small_scene(job, plugins, device, steps);
}

}  // namespace

void trial_job(ParcelReader& arguments) {
    const auto job = worker::arguments_in<TrialJob>(arguments);
    worker::enter_sandbox(worker::WorkerKind::driver);
    worker::answer(try_kernels(job).text());
}

}  // namespace clarity
