// compile_in_worker.hpp -- compiles one program in a worker process, and watches it.
#pragma once
#include "base/progress.hpp"
#include "compile/compile_job.hpp"
#include "device/device.hpp"
#include "worker/job.hpp"

namespace clarity {

// Seconds after which the user is told what still compiles: CLARITY_COMPILE_PATIENCE, or 60.
double compile_patience_s();

extern const worker::JobKind kCompileJob;

// The compiler ended its own process.
struct CompilerCrashed : Error {
    using Error::Error;
};

// Runs the job. what: for messages. work_group_method: see CompileJob. Throws CompilerCrashed, Error(kernel_build_failed) if
// the worker does not end as it should for another reason, both with what the compiler printed in details(), and Cancelled.
// Compiler errors are no failure: they are in the result.
CompileOutcome compile_in_worker(const DeviceInfo& info, const std::string& source, const std::string& options,
                                 const std::string& work_group_method, const std::string& what, Progress& progress);

}  // namespace clarity
