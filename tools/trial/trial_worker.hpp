// trial_worker.hpp -- tries kernels on a small scene, in a worker: what the core starts as the job kTrialJob
// (trial/trial_job.hpp).
#pragma once
#include "worker/job.hpp"

namespace clarity {

// kTrialJob with its work, for the program's list of workers.
const worker::JobKind& trial_worker();

}  // namespace clarity
