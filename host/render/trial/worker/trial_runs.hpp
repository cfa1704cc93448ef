// trial_runs.hpp -- what the worker that tries kernels does with them.
#pragma once
#include <functional>
#include <memory>

#include "base/problem.hpp"
#include "device/device.hpp"
#include "plugin/registry.hpp"
#include "render/trial/trial_job.hpp"

namespace clarity {

// Tells what kernels do next, in the past tense ("they traced a frame ..."), and how many seconds of processor time of all
// threads it may take.
using TrialSteps = std::function<void(const std::string& step, double limit_s)>;

// Runs kernels as the job says. Returns why there is no trial; nothing: the kernels have passed. Throws Error if they have
// not. job: of other kernels than the film's; its `settings` are those of the program that is tried.
Problem try_on_small_scene(const TrialJob& job, const PluginRegistry& plugins, const std::shared_ptr<Device>& device,
                           const TrialSteps& say_step);
// The same for the kernels of the film.
Problem try_film_kernels(const std::shared_ptr<Device>& device, const TrialSteps& say_step);

}  // namespace clarity
