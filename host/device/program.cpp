#include "device/program.hpp"

#include <chrono>
#include <regex>
#include <set>
#include <sstream>

#include "base/elapsed.hpp"
#include "device/kernel_files.hpp"

namespace clarity {
namespace {

const char* const kCompilerIsSilent = "the compiler gave no reason";

// One error or warning of a compiler's log.
struct Diagnostic {
    std::string severity, file, message;
    unsigned line = 0, column = 0;
};

unsigned number(const std::string& digits) {
    return digits.size() > 9 ? 0 : static_cast<unsigned>(std::stoul("0" + digits));
}

bool read_diagnostic(const std::string& line, Diagnostic& found) {
    static const std::regex placed(
        "^(?:(fatal error|error|warning|note): )?([^:]+):([0-9]+):(?:([0-9]+):)? ?"
        "(?:(fatal error|error|warning|note): )?(.*)$"),
        bare("^(fatal error|error|warning|note): (.*)$");
    std::smatch part;
    if (line.size() > 2000) return false;  // std::regex recurses for every character
    if (std::regex_match(line, part, placed) && (part[1].matched || part[5].matched)) {
        found = {part[1].matched ? part[1] : part[5], kernel_place(part[2]), part[6], number(part[3]), number(part[4])};
        return true;
    }
    if (!std::regex_match(line, part, bare)) return false;
    found = {part[1], "", part[2], 0, 0};
    return true;
}

std::string place(const std::string& file, unsigned line, unsigned column) {
    return file + ":" + std::to_string(line) + ":" + (column ? std::to_string(column) + ":" : "") + " ";
}

}  // namespace

CompilerLog read_compiler_log(const std::string& log) {
    static const std::regex noise(
        "^[0-9]+ (error|warning)s?( and [0-9]+ errors?)? generated\\.$|^Device .* failed to build the program$");
    CompilerLog result;
    std::istringstream lines(log);
    std::string line, fallback;
    std::set<std::string> said;
    bool repeated = false;  // the lines below a diagnostic that was there before: the source line, the caret
    while (std::getline(lines, line)) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        Diagnostic found;
        if (line.size() < 200 && std::regex_match(line, noise)) continue;
        if (read_diagnostic(line, found)) {
            // A traversal is included up to four times, and each time the compiler finds the same.
            repeated = !said.insert(place(found.file, found.line, found.column) + found.severity + found.message).second;
            if (repeated) continue;
            const bool error = found.severity.find("error") != std::string::npos;
            if (error && result.errors++ == 0) result.first = {found.file, found.line, found.column, found.message};
            line =
                (found.file.empty() ? "" : place(found.file, found.line, found.column)) + found.severity + ": " + found.message;
        } else if (repeated) {
            continue;
        } else if (fallback.empty()) {
            fallback = line;
        }
        result.text += line + "\n";
    }
    while (!result.text.empty() && result.text.back() == '\n') result.text.pop_back();
    if (result.first.message.empty()) result.first.message = fallback.empty() ? kCompilerIsSilent : fallback;
    return result;
}

Error build_error(const DeviceInfo& info, const std::string& what, int code, const std::string& raw) {
    const CompilerLog log = read_compiler_log(raw.c_str());  // c_str(): some drivers include the final 0 in the length
    const SourceLocation& first = log.first;
    std::string message = first.file.empty() ? "" : place(first.file, first.line, first.column);
    message += log.text.empty() ? "OpenCL error " + std::to_string(code) : first.message;
    message += " (compiling " + what + " for " + info.name;
    if (log.errors > 1) message += "; " + std::to_string(log.errors - 1) + (log.errors == 2 ? " more error" : " more errors");
    return Error(Exit::kernel_build_failed, message + ")", log.text, first);
}

BuildResult build_program(Device& device, const std::string& source, const std::string& options, const std::string& what) {
    const auto start = std::chrono::steady_clock::now();
    BuildResult result;
    const cl::Device& cl_device = device.info().cl_device;
    try {
        result.program = cl::Program(device.context(), source);
        result.program.build(cl_device, options.c_str());
        result.log = result.program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(cl_device);
    } catch (const cl::Error& e) {
        std::string raw;
        if (result.program()) {
            try {
                raw = result.program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(cl_device);
            } catch (const cl::Error&) {  // the error says more than a log that cannot be read
            }
        }
        throw build_error(device.info(), what, e.err(), raw);
    }
    result.ms = ms_since(start);
    return result;
}

}  // namespace clarity
