#include "compile/compile_job.hpp"

#include <malloc.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "device/device.hpp"
#include "worker/child.hpp"

namespace clarity {
namespace {

// Lets launches find what PoCL compiles for a binary.
//
// In its folder PoCL has a library for each kernel and each kind of launch, XX/PROGRAM/KERNEL/FORM/KERNEL.so. For a binary it
// compiles the form 0-0-0, which is right for every launch. A launch looks for the form of its local size, offset and range,
// and compiles it if it is missing, in the process that launches. A link to 0-0-0 stands in for it, and PoCL follows links when
// it packs the folder. The other form is no faster, as a work-group of ours is one work-item on a CPU: traversals have the same
// machine code, and rays take the same time (PoCL 3.1; bvh8 with 16 lanes, bvh2 with one; to 2 %).

namespace fs = std::filesystem;

// What launches of ours ask for behind the local size: they have one dimension and no offset. The second one is for less than
// 2^16 work-items.
constexpr const char* kForms[] = {"-1-1-goffs0", "-1-1-goffs0-smallgrid"};
constexpr size_t kGroup = 64;  // local size of all kernels that require none (FilmKernels, Denoiser)

// The one program's in PoCL's folder; empty: none.
fs::path folder_of_program(const fs::path& pocl_cache) {
    std::error_code error;
    for (fs::recursive_directory_iterator at(pocl_cache, error), end; !error && at != end; at.increment(error))
        if (at->path().filename() == "program.bc") return at->path().parent_path();
    return {};
}

// Call it before the binary is asked for. Where PoCL keeps its forms otherwise, the links are of no use.
void link_forms(const Device& device, cl::Program program, const fs::path& pocl_cache) {
    const fs::path folder = folder_of_program(pocl_cache);
    if (folder.empty()) return;
    std::vector<cl::Kernel> kernels;
    program.createKernels(&kernels);
    for (const cl::Kernel& kernel : kernels) {
        const fs::path forms = folder / kernel.getInfo<CL_KERNEL_FUNCTION_NAME>().c_str();
        const cl::size_type required = kernel.getWorkGroupInfo<CL_KERNEL_COMPILE_WORK_GROUP_SIZE>(device.info().cl_device)[0];
        std::error_code ignored;
        fs::create_directory(forms, ignored);
        for (const char* form : kForms)
            fs::create_directory_symlink("0-0-0", forms / (std::to_string(required ? required : kGroup) + form), ignored);
    }
}

std::vector<char> binary_of(const cl::Program& program) {
    size_t bytes = 0;
    if (clGetProgramInfo(program(), CL_PROGRAM_BINARY_SIZES, sizeof bytes, &bytes, nullptr) != CL_SUCCESS) return {};
    std::vector<char> binary(bytes);
    unsigned char* place = reinterpret_cast<unsigned char*>(binary.data());
    if (bytes == 0 || clGetProgramInfo(program(), CL_PROGRAM_BINARIES, sizeof place, &place, nullptr) != CL_SUCCESS) return {};
    return binary;
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
    worker::say_step("generating code for");
    if (!job.pocl_cache.empty()) link_forms(*device, program, job.pocl_cache);
    outcome.binary = binary_of(program);
    return outcome;
}

}  // namespace

void compile_job(ParcelReader& arguments) {
    const auto job = worker::arguments_in<CompileJob>(arguments);
    if (!job.pocl_cache.empty()) setenv("POCL_CACHE_DIR", job.pocl_cache.c_str(), 1);
    if (!job.work_group_method.empty()) setenv("POCL_WORK_GROUP_METHOD", job.work_group_method.c_str(), 1);
    keep_freed_memory();
    worker::enter_sandbox(worker::WorkerKind::driver);
    try {
        worker::answer(compile(job));
    } catch (const cl::Error& e) {
        throw Error(Exit::failed, std::string(e.what()) + " failed with OpenCL error " + std::to_string(e.err()));
    }
}

}  // namespace clarity
