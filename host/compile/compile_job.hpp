// compile_job.hpp -- what a compilation in a worker takes and returns.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/files/parcel.hpp"

namespace clarity {

// Program to worker.
struct CompileJob {
    std::string source, options;
    std::string device, name, driver;  // id as `--device` takes it; the worker refuses a device of another name or driver
    std::string pocl_cache;            // an empty folder that PoCL compiles into; empty: its usual one
    std::string work_group_method;     // POCL_WORK_GROUP_METHOD; empty: as the user has it
    CLARITY_MEMBERS(source, options, device, name, driver, pocl_cache, work_group_method);
};

// Worker to program.
struct CompileOutcome {
    enum State : uint32_t { compiled, failed, no_device };
    uint32_t state = compiled;
    int32_t error = 0;         // OpenCL's, if failed
    std::string log;           // the compiler's; why, if there is no device
    std::vector<char> binary;  // empty: the driver gives none
    CLARITY_MEMBERS(state, error, log, binary);
};

// The work of kCompileJob.
void compile_job(ParcelReader& arguments);

}  // namespace clarity
