#include "compile/compile.hpp"

#include <chrono>
#include <mutex>
#include <optional>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/timeline.hpp"
#include "compile/compile_in_worker.hpp"
#include "compile/program_store.hpp"

namespace clarity {
namespace {

// Returns nothing if the driver refuses its own binary.
std::optional<cl::Program> program_of(Device& device, const std::vector<char>& binary, const std::string& options) {
    // PoCL 3.1 and 5.0 unpack a binary into their folder, and remove a file there that another thread has just written.
    static std::mutex unpacking;
    const std::lock_guard<std::mutex> lock(unpacking);
    try {
        cl::Program program(device.context(), {device.info().cl_device},
                            {std::vector<unsigned char>(binary.begin(), binary.end())});
        program.build(device.info().cl_device, options.c_str());
        return program;
    } catch (const cl::Error& e) {
        log(LogLevel::debug, device.info().name + " refuses the binary of a program, which is compiled again: " + e.what() +
                                 " failed with OpenCL error " + std::to_string(e.err()));
        return std::nullopt;
    }
}

// Compiles a program that is not on disk, and keeps it there.
CompileOutcome compile_first(const DeviceInfo& info, const CompileRequest& request, Progress& progress) {
    CompileOutcome outcome = compile_in_worker(info, request.source, request.options, request.what, progress);
    if (outcome.state == CompileOutcome::compiled)
        keep_program(program_key(info, request.source, request.options), outcome.binary);
    return outcome;
}

}  // namespace

BuildResult compile_program(Device& device, const CompileRequest& request, Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    const timeline::Scope span("compile", [&] { return "compile " + request.what; });
    const DeviceInfo& info = device.info();
    const auto here = [&] {
        BuildResult built = build_program(device, request.source, request.options, request.what);
        built.ms = ms_since(start);
        return built;
    };
    if (!compiles_in_worker()) return here();
    const std::string key = program_key(info, request.source, request.options);
    BuildResult result;
    std::optional<std::vector<char>> binary = find_program(key);
    if (!binary) {
        CompileOutcome outcome = compile_first(info, request, progress);
        if (outcome.state == CompileOutcome::failed) throw build_error(info, request.what, outcome.error, outcome.log);
        if (outcome.state == CompileOutcome::no_device)
            log(LogLevel::debug, "compiling in this process: the worker cannot open the device: " + outcome.log);
        result.log = outcome.log;
        binary = std::move(outcome.binary);
    }
    if (!binary->empty()) {
        auto program = program_of(device, *binary, request.options);
        if (program) {
            result.program = *program;
            result.ms = ms_since(start);
            return result;
        }
        forget_program(key);
    }
    set_aside(key);
    BuildResult built = here();
    put_back(key);
    return built;
}

void compile_ahead(const DeviceInfo& info, const CompileRequest& request, Progress& progress) {
    if (!compiles_in_worker() || !keeps_programs()) return;
    try {
        if (!find_program(program_key(info, request.source, request.options))) compile_first(info, request, progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& e) {
        log(LogLevel::debug, "compiling " + request.what + " ahead: " + e.what());
    }
}

}  // namespace clarity
