// compile_worker_main.cpp -- main function of the worker process that compiles one program.
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "base/error.hpp"
#include "base/log.hpp"
#include "compile/compile.hpp"
#include "compile/compile_wire.hpp"
#include "compile/pocl_forms.hpp"
#include "compile/zero_launch.hpp"
#include "worker/child.hpp"
#include "worker/sandbox.hpp"

namespace clarity {
namespace {

using worker::MessageKind;

// The parent says `proceed` when the job is written.
CompileJob wait_for_job() {
    worker::Message message;
    do {
        pollfd ready = {worker::kChannelFd, POLLIN, 0};
        poll(&ready, 1, -1);
        if (receive_message(worker::kChannelFd, message) == worker::Received::closed) _exit(1);
    } while (message.kind != MessageKind::proceed);
    CompileJob job;
    const std::string why = read_compile_job(worker::kResultFd, job);
    if (!why.empty()) throw Error(Exit::failed, why);
    return job;
}

void say_step(const char* step) {
    worker::take_crash_signals();  // the driver, loaded or first used since the last step, may have set its own
    worker::send_message(worker::kChannelFd, {MessageKind::running, 0, 0, step});
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
    say_step("compiling");
    cl::Program program(device->context(), job.source);
    outcome.error = clBuildProgram(program(), 1, &cl_device(), job.options.c_str(), nullptr, nullptr);
    outcome.log = log_of(program, cl_device);
    if (outcome.error != CL_SUCCESS) {
        outcome.state = CompileOutcome::failed;
        return outcome;
    }
    if (job.ends_on_zeros) {
        say_step("launching");
        launch_on_zeros(*device, program);
        if (device->info().pocl) share_launched_forms(kernels_of(program));
    }
    if (job.wants_binary) outcome.binary = binary_of(program);
    return outcome;
}

void run() {
    const CompileJob job = wait_for_job();
    if (!job.pocl_cache.empty()) setenv("POCL_CACHE_DIR", job.pocl_cache.c_str(), 1);
    for (const std::string& note : worker::enter_sandbox(worker::WorkerKind::driver, {}, {}, {}))
        log(LogLevel::debug, "compile worker: " + note);
    const std::string why = write_compile_outcome(worker::kResultFd, compile(job));
    if (!why.empty()) throw Error(Exit::failed, why);
}

}  // namespace

// compile-worker --parent PID
int compile_worker_main(int argc, char** argv) {
    constexpr const char* instead = "to compile kernels, run `clarity render`";
    const long parent = argc == 4 && std::strcmp(argv[2], "--parent") == 0 ? std::strtol(argv[3], nullptr, 10) : 0;
    if (!worker::begin_worker(worker::kCompileGreeting, parent, instead)) return static_cast<int>(Exit::usage);
    worker::Message last{MessageKind::done, 0, 0, {}};
    try {
        run();
    } catch (const cl::Error& e) {
        last.kind = MessageKind::failed;
        last.text = std::string(e.what()) + " failed with OpenCL error " + std::to_string(e.err());
    } catch (const std::exception& e) {
        last.kind = MessageKind::failed;
        last.text = e.what();
    }
    std::fflush(nullptr);  // what the compiler printed comes before the end
    worker::send_message(worker::kChannelFd, last);
    _exit(last.kind == MessageKind::done ? 0 : 1);  // without destructors: a driver may crash in them
}

}  // namespace clarity
