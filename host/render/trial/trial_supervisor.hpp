// trial_supervisor.hpp -- follows the worker that tries kernels, and says how they failed.
#pragma once
#include <string>

#include "base/progress.hpp"
#include "worker/supervisor.hpp"

namespace clarity {

class TrialSupervisor : public worker::Supervisor {
 public:
    TrialSupervisor(worker::WorkerProcess& process, Progress& progress);
    // Why there was no trial, through no fault of the kernels; empty: there was one.
    const std::string& not_tried() const { return not_tried_; }

 private:
    void handle(const worker::Message& message) override;
    double idle_limit_s() const override { return limit_s_; }
    bool counts_processor_time() const override { return true; }
    uint64_t processor_limit_s() const override { return 0; }
    uint64_t memory_limit_bytes() const override;
    std::string speaker() const override { return "the trial of kernels"; }
    // Throws Error(kernel_build_failed): "crashed (...) while they traced a frame ...".
    void ended(const worker::Ending& ending) const override;

    std::string step_ = "starting", not_tried_;
    double limit_s_ = 60;
};

}  // namespace clarity
