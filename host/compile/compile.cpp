#include "compile/compile.hpp"

#include <chrono>
#include <optional>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/timeline.hpp"
#include "compile/compile_in_worker.hpp"
#include "compile/program_store.hpp"
#include "device/kernel_files.hpp"

namespace clarity {
namespace {

// Returns nothing if the driver refuses its own binary.
std::optional<cl::Program> program_of(Device& device, const std::vector<char>& binary, const std::string& options) {
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

// A request for one device. PoCL compiles kernels when they are first launched, so the worker launches them if it may.
struct DeviceRequest {
    DeviceRequest(const DeviceInfo& of, const CompileRequest& request)
        : info(of),
          // A kernel that was edited may end on zeros or not.
          launches(of.pocl && request.ends_on_zeros && edited_kernels().empty()),
          options(request.options + (launches ? " -cl-kernel-arg-info" : "")),
          key(program_key(of, request.source, options)) {}
    const DeviceInfo& info;
    const bool launches;
    const std::string options, key;
};

// Compiles a program that is not on disk, and keeps it there.
CompileOutcome compile_first(const DeviceRequest& wanted, const CompileRequest& request, Progress& progress) {
    const DeviceInfo& info = wanted.info;
    // For the binary of a program that was not launched PoCL generates code, which the first launch does anyhow. Its entry in
    // PoCL's cache serves as well then.
    const bool wants_binary = !info.pocl || wanted.launches;
    const std::string folder = info.pocl ? folder_for_worker() : std::string();
    const CompileJob job{request.source, wanted.options,  info.id(),    info.name,
                         info.driver,    wanted.launches, wants_binary, folder};
    CompileOutcome outcome;
    try {
        outcome = compile_in_worker(info, job, request.what, progress);
    } catch (...) {
        drop_folder(folder);
        throw;
    }
    if (outcome.state == CompileOutcome::compiled && outcome.binary.empty() && !folder.empty()) {
        take_entry(wanted.key, folder);
        return outcome;
    }
    if (outcome.state == CompileOutcome::compiled) keep_program(wanted.key, outcome.binary);
    drop_folder(folder);
    return outcome;
}

// Whether PoCL's cache has the program already, or has it now from the store.
bool finds_entry(const DeviceRequest& wanted, const std::optional<std::vector<char>>& stored) {
    return has_entry(wanted.key) || (stored && wanted.info.pocl && unpack_entry(wanted.key, *stored));
}

// What the store has of a program. A note that it compiles is of no use if PoCL has lost its cache since.
std::optional<std::vector<char>> stored_program(const DeviceRequest& wanted) {
    auto stored = find_program(wanted.key);
    if (stored && stored->empty() && wanted.info.pocl && has_own_pocl_cache()) stored.reset();
    return stored;
}

}  // namespace

BuildResult compile_program(Device& device, const CompileRequest& request, Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    const timeline::Scope span("compile", [&] { return "compile " + request.what; });
    const DeviceInfo& info = device.info();
    const auto here = [&](const std::string& options) {
        BuildResult built = build_program(device, request.source, options, request.what);
        built.ms = ms_since(start);
        return built;
    };
    if (!compiles_in_worker()) return here(request.options);
    const DeviceRequest wanted(info, request);
    BuildResult result;
    std::optional<std::vector<char>> binary = stored_program(wanted);
    if (finds_entry(wanted, binary)) return here(wanted.options);
    if (!binary) {
        CompileOutcome outcome = compile_first(wanted, request, progress);
        if (outcome.state == CompileOutcome::failed) throw build_error(info, request.what, outcome.error, outcome.log);
        if (outcome.state == CompileOutcome::no_device)
            log(LogLevel::debug, "compiling in this process: the worker cannot open the device: " + outcome.log);
        result.log = outcome.log;
        binary = std::move(outcome.binary);
    }
    if (!binary->empty()) {
        auto program = program_of(device, *binary, wanted.options);
        if (program) {
            result.program = *program;
            result.ms = ms_since(start);
            return result;
        }
        forget_program(wanted.key);
    }
    set_aside(wanted.key);
    BuildResult built = here(wanted.options);
    put_back(wanted.key);
    return built;
}

void compile_ahead(const DeviceInfo& info, const CompileRequest& request, Progress& progress) {
    if (!compiles_in_worker() || !keeps_programs()) return;
    const DeviceRequest wanted(info, request);
    try {
        if (!has_entry(wanted.key) && !stored_program(wanted)) compile_first(wanted, request, progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& e) {
        log(LogLevel::debug, "compiling " + request.what + " ahead: " + e.what());
    }
}

}  // namespace clarity
