// worker_main.cpp -- main function of the worker process that tries kernels.
#include <unistd.h>

#include <cstdio>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/log.hpp"
#include "render/trial/trial.hpp"
#include "render/trial/worker/trial_runs.hpp"
#include "worker/child.hpp"
#include "worker/sandbox.hpp"

namespace clarity {
namespace {

using worker::MessageKind;

// Mesa's llvmpipe compiles a kernel when it is first launched with a size of work-group. Seconds; measured 20 to 90.
constexpr double kLlvmpipeCompiles_s = 150;

void say_step(const std::string& step, double limit_s) {
    worker::take_crash_signals();
    worker::send_message(worker::kChannelFd, {MessageKind::running, 0, static_cast<float>(limit_s), step});
}

// Returns why there is no trial; empty: the kernels have passed. Throws Error if they have not.
std::string try_kernels(const TrialArguments& arguments) {
    std::vector<std::string> libraries;
    for (const auto& [loaded, original] : arguments.libraries) {
        if (loaded != original) note_private_copy(loaded, original);
        libraries.push_back(loaded);
    }
    const PluginRegistry plugins = PluginRegistry::of(libraries);
    std::shared_ptr<Device> device;
    try {
        device = std::make_shared<Device>(choose_device(arguments.device));
    } catch (const Error& e) {
        return e.what();
    }
    if (device->info().name != arguments.device_name)
        return "device " + arguments.device + " is " + device->info().name + " here";
    const TrialSteps steps = [more_s = device->info().llvmpipe ? kLlvmpipeCompiles_s : 0](
                                 const std::string& step, double limit_s) { say_step(step, limit_s + more_s); };
    return arguments.kernels == kFilmKernels ? try_film_kernels(device, steps)
                                             : try_on_small_scene(arguments, plugins, device, steps);
}

}  // namespace

int trial_worker_main(int argc, char** argv) {
    constexpr const char* instead = "to try kernels, run `clarity check`";
    TrialArguments arguments;
    try {
        arguments = read_trial_arguments(argc, argv);
    } catch (const Error& e) {
        std::fprintf(stderr, "workers are started by clarity itself; %s (%s)\n", instead, e.what());
        return static_cast<int>(Exit::usage);
    }
    if (!worker::begin_worker(worker::kTrialGreeting, arguments.parent, instead)) return static_cast<int>(Exit::usage);
    worker::Message last{MessageKind::done, 0, 0, {}};
    try {
        for (const std::string& note : worker::enter_sandbox(worker::WorkerKind::driver, {}, {}, {}))
            log(LogLevel::debug, "trial worker: " + note);
        if (const std::string why = try_kernels(arguments); !why.empty())
            worker::send_message(worker::kChannelFd, {MessageKind::report, 0, 0, why});
    } catch (const std::exception& e) {
        last.kind = MessageKind::failed;
        last.text = e.what();
    }
    std::fflush(nullptr);
    worker::send_message(worker::kChannelFd, last);
    _exit(last.kind == MessageKind::done ? 0 : 1);  // without destructors: a launch may still run
}

}  // namespace clarity
