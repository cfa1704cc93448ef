#include "device/program.hpp"

#include <chrono>
#include <sstream>

#include "base/error.hpp"

namespace clarity {
namespace {

// The first line that a person should see of a compiler's log.
std::string first_error(const std::string& log) {
    std::istringstream lines(log);
    std::string line, fallback;
    while (std::getline(lines, line)) {
        if (line.find("error") != std::string::npos) return line;
        if (fallback.empty() && !line.empty()) fallback = line;
    }
    return fallback.empty() ? "the compiler gave no reason" : fallback;
}

}  // namespace

BuildResult build_program(Device& device, const std::string& source, const std::string& options, const std::string& what) {
    const auto start = std::chrono::steady_clock::now();
    BuildResult result;
    const cl::Device& cl_device = device.info().cl_device;
    try {
        result.program = cl::Program(device.context(), source);
        result.program.build(cl_device, options.c_str());
        result.log = result.program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(cl_device);
    } catch (const cl::Error& e) {
        std::string log;
        if (result.program()) {
            try {
                log = result.program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(cl_device);
            } catch (const cl::Error&) {
            }
        }
        throw Error(Exit::kernel_build_failed,
                    what + ": the kernels do not compile on " + device.info().name + ": " +
                        (log.empty() ? "OpenCL error " + std::to_string(e.err()) : first_error(log)),
                    log);
    }
    result.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return result;
}

}  // namespace clarity
