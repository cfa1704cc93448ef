#include "compile/compile.hpp"

#include <chrono>
#include <mutex>
#include <optional>
#include <vector>

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

// How a compiler can be made to take other paths to the same program.
struct Way {
    const char* options;            // besides the request's
    const char* work_group_method;  // of PoCL, which alone has some; empty: its usual one
    const char* consequence;        // for the user
};

// LLVM 18, which PoCL 6.0 uses, ends the process where one of its passes has more to do when it is run again
// ("Instruction Combining did not reach a fixpoint"). No text of ours can rule that out. So where a compiler crashes, it is
// tried in the next way. Work-groups of our kernels for CPUs are one work-item, which all methods make the same of, and as
// fast (docs/performance.md). The last way is slow.
constexpr Way kWays[] = {
    {"", "", ""},
    {"", "cbs", "in another way of the compiler's"},
    {" -cl-opt-disable", "cbs", "without the compiler's optimiser, so pictures will take longer"},
};

// A program for one device, compiled in one way. Two ways have the same key if they do not differ for this device.
struct DeviceRequest {
    DeviceRequest(const DeviceInfo& of, const CompileRequest& what, const Way& by)
        : info(of),
          request(what),
          way(by),
          options(what.options + by.options),
          work_group_method(of.pocl ? by.work_group_method : ""),
          key(program_key(of, what.source, options + work_group_method)) {}
    const DeviceInfo& info;
    const CompileRequest& request;
    const Way& way;
    const std::string options, work_group_method, key;
};

BuildResult build_here(Device& device, const DeviceRequest& wanted) {
    return build_program(device, wanted.request.source, wanted.options, wanted.request.what);
}

// Compiles a program that is not on disk, and keeps it there.
CompileOutcome compile_first(const DeviceRequest& wanted, Progress& progress) {
    CompileOutcome outcome = compile_in_worker(wanted.info, wanted.request.source, wanted.options, wanted.work_group_method,
                                               wanted.request.what, progress);
    if (outcome.state == CompileOutcome::compiled) keep_program(wanted.key, outcome.binary);
    return outcome;
}

// The program from its binary, or compiled here if that is empty or refused.
BuildResult take(Device& device, const DeviceRequest& wanted, const std::vector<char>& binary) {
    if (!binary.empty()) {
        BuildResult result;
        if (auto program = program_of(device, binary, wanted.options)) {
            result.program = *program;
            return result;
        }
        forget_program(wanted.key);
    }
    if (!wanted.work_group_method.empty())  // it is too late to tell PoCL in this process
        throw Error(Exit::kernel_build_failed, wanted.info.name + " gives no binary of " + wanted.request.what +
                                                   ", or refuses its own, and crashes at compiling it as usual");
    set_aside(wanted.key);
    BuildResult built = build_here(device, wanted);
    put_back(wanted.key);
    return built;
}

// A program that was compiled before.
std::optional<BuildResult> load(Device& device, const DeviceRequest& wanted) {
    const auto stored = find_program(wanted.key);
    if (!stored) return std::nullopt;
    return take(device, wanted, *stored);
}

BuildResult compile(Device& device, const DeviceRequest& wanted, Progress& progress) {
    const CompileOutcome outcome = compile_first(wanted, progress);
    if (outcome.state == CompileOutcome::failed)
        throw build_error(wanted.info, wanted.request.what, outcome.error, outcome.log);
    if (outcome.state == CompileOutcome::no_device)
        log(LogLevel::debug, "compiling in this process: the worker cannot open the device: " + outcome.log);
    BuildResult result = take(device, wanted, outcome.binary);
    result.log = outcome.log;
    return result;
}

// Returns load(program), or, where that gives nothing, compile(program). If the compiler crashes at it, or has done so before,
// the program is one of another way: it alone is kept then, which tells later starts. Throws the first CompilerCrashed where
// all ways end so.
template <class Load, class Compile>
auto compile_in_spite_of_crashes(const DeviceInfo& info, const CompileRequest& request, const Load& load,
                                 const Compile& compile) {
    std::vector<DeviceRequest> ways;
    for (const Way& way : kWays) {
        const DeviceRequest wanted(info, request, way);
        if (!ways.empty() && wanted.key == ways.back().key) continue;
        if (auto loaded = load(wanted)) return *loaded;
        ways.push_back(wanted);
    }
    std::optional<CompilerCrashed> first;
    for (const DeviceRequest& wanted : ways) {
        if (first) log(LogLevel::warning, std::string(first->what()) + "; compiling again " + wanted.way.consequence);
        try {
            return compile(wanted);
        } catch (const CompilerCrashed& crash) {
            if (!first) first = crash;
        }
    }
    throw *first;
}

}  // namespace

BuildResult compile_program(Device& device, const CompileRequest& request, Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    const timeline::Scope span("compile", [&] { return "compile " + request.what; });
    if (!compiles_in_worker()) return build_program(device, request.source, request.options, request.what);
    BuildResult built = compile_in_spite_of_crashes(
        device.info(), request, [&](const DeviceRequest& wanted) { return load(device, wanted); },
        [&](const DeviceRequest& wanted) { return compile(device, wanted, progress); });
    built.ms = ms_since(start);
    return built;
}

void compile_ahead(const DeviceInfo& info, const CompileRequest& request, Progress& progress) {
    if (!compiles_in_worker() || !keeps_programs()) return;
    struct Kept {};
    try {
        compile_in_spite_of_crashes(
            info, request,
            [](const DeviceRequest& wanted) { return find_program(wanted.key) ? std::optional<Kept>(Kept()) : std::nullopt; },
            [&](const DeviceRequest& wanted) {
                compile_first(wanted, progress);
                return Kept();
            });
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& e) {
        log(LogLevel::debug, "compiling " + request.what + " ahead: " + e.what());
    }
}

}  // namespace clarity
