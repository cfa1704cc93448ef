#include "compile/compile_job.hpp"

#include <malloc.h>

#include <cstdlib>
#include <sstream>

#include "base/error.hpp"
#include "compile/pocl_forms.hpp"
#include "compile/zero_launch.hpp"
#include "device/device.hpp"
#include "worker/child.hpp"

namespace clarity {
namespace {

std::vector<char> binary_of(const cl::Program& program) {
    size_t bytes = 0;
    if (clGetProgramInfo(program(), CL_PROGRAM_BINARY_SIZES, sizeof bytes, &bytes, nullptr) != CL_SUCCESS) return {};
    std::vector<char> binary(bytes);
    unsigned char* place = reinterpret_cast<unsigned char*>(binary.data());
    if (bytes == 0 || clGetProgramInfo(program(), CL_PROGRAM_BINARIES, sizeof place, &place, nullptr) != CL_SUCCESS) return {};
    return binary;
}

std::vector<std::string> kernels_of(const cl::Program& program) {
    std::vector<std::string> names;
    std::istringstream text(program.getInfo<CL_PROGRAM_KERNEL_NAMES>());
    for (std::string name; std::getline(text, name, ';');) names.push_back(name);
    return names;
}

std::string log_of(const cl::Program& program, const cl::Device& device) {
    size_t bytes = 0;
    clGetProgramBuildInfo(program(), device(), CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
    std::string text(bytes, '\0');
    if (clGetProgramBuildInfo(program(), device(), CL_PROGRAM_BUILD_LOG, bytes, text.data(), nullptr) != CL_SUCCESS) return {};
    return text.c_str();  // without the final 0
}

// LLVM frees a pass's memory and asks for it again in the next one. Given back to the system meanwhile, each page is cleared
// anew.
void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int kMost = 1 << 30, kStep = 64 << 20, kLargestBlock = 32 << 20;
    mallopt(M_TRIM_THRESHOLD, kMost);
    mallopt(M_TOP_PAD, kStep);
    mallopt(M_MMAP_THRESHOLD, kLargestBlock);
#endif
}

CompileOutcome compile(const CompileJob& job) {
    CompileOutcome outcome;
    std::unique_ptr<Device> device;
    try {
        device = std::make_unique<Device>(choose_device(job.device));
        const DeviceInfo& info = device->info();
        if (info.name != job.name || info.driver != job.driver)
            throw Error(Exit::no_device, "device " + job.device + " is " + info.name + " here");
    } catch (const Error& e) {
        outcome.state = CompileOutcome::no_device;
        outcome.log = e.what();
        return outcome;
    }
    const cl::Device& cl_device = device->info().cl_device;
    worker::say_step("compiling");
    cl::Program program(device->context(), job.source);
    outcome.error = clBuildProgram(program(), 1, &cl_device(), job.options.c_str(), nullptr, nullptr);
    outcome.log = log_of(program, cl_device);
    if (outcome.error != CL_SUCCESS) {
        outcome.state = CompileOutcome::failed;
        return outcome;
    }
    if (job.ends_on_zeros) {
        worker::say_step("generating code for");
        launch_on_zeros(*device, program);
        if (device->info().pocl) share_launched_forms(kernels_of(program));
    }
    if (job.wants_binary) outcome.binary = binary_of(program);
    return outcome;
}

}  // namespace

void compile_job(ParcelReader& arguments) {
    const auto job = worker::arguments_in<CompileJob>(arguments);
    if (!job.pocl_cache.empty()) setenv("POCL_CACHE_DIR", job.pocl_cache.c_str(), 1);
    keep_freed_memory();
    worker::enter_sandbox(worker::WorkerKind::driver);
    try {
        worker::answer(compile(job));
    } catch (const cl::Error& e) {
        throw Error(Exit::failed, std::string(e.what()) + " failed with OpenCL error " + std::to_string(e.err()));
    }
}

}  // namespace clarity
