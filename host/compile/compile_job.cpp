#include "compile/compile_job.hpp"

#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "device/device.hpp"
#include "device/pocl_cache.hpp"
#include "worker/child.hpp"

namespace clarity {
namespace {

// Launches the kernels of a program once on buffers of zeros. PoCL compiles a kernel when it is first
// launched with a work-group size: this compiles it without a scene.
constexpr size_t kBufferBytes = 64 << 10, kLocalBytes = 16 << 10, kGroup = 64;
constexpr size_t kMostBytes = 128;  // of an argument by value: a vector of 16 doubles

// The size of an argument by value is not asked for in OpenCL 1.2; the driver refuses the wrong ones.
void set_zero(cl::Kernel& kernel, cl_uint at) {
    const char zeros[kMostBytes] = {};
    cl_int error = CL_INVALID_ARG_SIZE;
    for (size_t bytes = 1; bytes <= kMostBytes && error != CL_SUCCESS; bytes *= 2)
        error = clSetKernelArg(kernel(), at, bytes, zeros);
    if (error != CL_SUCCESS) throw cl::Error(error, "clSetKernelArg");
}

// All kernels must end at once on zeros. Their arguments must be known: the program was compiled with -cl-kernel-arg-info.
// Kernels without a required work-group size are launched with 64 work-items, as FilmKernels does. Throws cl::Error.
void launch_on_zeros(Device& device, const cl::Program& program) {
    cl::Program compiled = program;
    std::vector<cl::Kernel> kernels;
    compiled.createKernels(&kernels);
    for (cl::Kernel& kernel : kernels) {
        std::vector<cl::Buffer> buffers;
        const auto count = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
        for (cl_uint at = 0; at < count; ++at) {
            const auto space = kernel.getArgInfo<CL_KERNEL_ARG_ADDRESS_QUALIFIER>(at);
            if (space == CL_KERNEL_ARG_ADDRESS_PRIVATE) {
                set_zero(kernel, at);
            } else if (space == CL_KERNEL_ARG_ADDRESS_LOCAL) {
                kernel.setArg(at, cl::Local(kLocalBytes));
            } else {
                buffers.emplace_back(device.context(), CL_MEM_READ_WRITE, kBufferBytes);
                device.queue().enqueueFillBuffer(buffers.back(), cl_uint(0), 0, kBufferBytes);
                kernel.setArg(at, buffers.back());
            }
        }
        const cl::size_type required = kernel.getWorkGroupInfo<CL_KERNEL_COMPILE_WORK_GROUP_SIZE>(device.info().cl_device)[0];
        const size_t local = required ? required : kGroup;
        device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(local), cl::NDRange(local));
        device.queue().finish();
    }
}

// Makes the binaries of PoCL cheap.
//
// PoCL keeps a form of each kernel for each kind of launch in its cache, KERNEL/LOCAL-goffs0-smallgrid/KERNEL.so. When it is
// asked for a binary it also compiles a form for any local size, KERNEL/0-0-0/KERNEL.so, which takes as long as all that was
// compiled before (PoCL 3.1; Cornell box on an AMD EPYC: 12.5 s instead of 6.9 s). No launch of ours uses that form: all our
// kernels have one local size. A second name of the launched form stands in for it.

namespace fs = std::filesystem;

std::vector<fs::path> folders_in(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error, gone;  // others may remove folders meanwhile
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        if (at->is_directory(gone)) found.push_back(at->path());
    return found;
}

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

void share_form_of(const fs::path& kernel_folder) {
    std::error_code ignored;
    const fs::path file = kernel_folder.filename().string() + ".so", general = kernel_folder / "0-0-0" / file;
    if (fs::exists(general, ignored)) return;
    for (const fs::path& form : folders_in(kernel_folder)) {
        if (!ends_with(form.filename().string(), "-goffs0-smallgrid") || !fs::exists(form / file, ignored)) continue;
        fs::create_directory(general.parent_path(), ignored);
        fs::create_hard_link(form / file, general, ignored);
        return;
    }
}

// Names the launched forms of a program a second time, in the folder pocl_cache(). kernels: all those of the program, launched
// once before. Where PoCL keeps its forms otherwise nothing happens, and PoCL compiles. Throws nothing.
void share_launched_forms(const std::vector<std::string>& kernels) {
    const fs::path cache = pocl_cache();
    if (cache.empty()) return;
    for (const fs::path& group : folders_in(cache))
        for (const fs::path& program : folders_in(group)) {
            const auto has = [&](const std::string& kernel) {
                std::error_code error;
                return fs::is_directory(program / kernel, error);
            };
            // Programs of the same kernels with other settings may be served, too: their launches are alike.
            if (!std::all_of(kernels.begin(), kernels.end(), has)) continue;
            for (const std::string& kernel : kernels) share_form_of(program / kernel);
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
