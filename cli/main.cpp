// clarity: parses the command line, runs one command, and turns its exceptions into a message and an exit code.
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

#include "base/error.hpp"
#include "base/files/process_folder.hpp"
#include "base/log.hpp"
#include "base/timeline.hpp"
#include "cli/command_line.hpp"
#include "cli/interrupt.hpp"
#include "compile/compile_in_worker.hpp"
#include "device/device_loss.hpp"
#include "import/import_in_worker.hpp"
#include "plugin/trust.hpp"
#include "structures/accel_build.hpp"
#include "tools/check/check.hpp"
#include "tools/lab/build.hpp"
#include "tools/lab/measure.hpp"
#include "tools/trial/trial_worker.hpp"
#include "worker/child.hpp"

namespace clarity {
namespace {

void set_up_log(const CommonOptions& common) {
    if (common.verbose) set_log_level(LogLevel::debug);
    if (common.quiet) set_log_level(LogLevel::warning);
    if (!common.log_file.empty()) set_log_file(common.log_file);
}

PluginRegistry find_plugins(const CommandLine& line) {
    PluginRegistry plugins = PluginRegistry::discover(line.common.plugin_files, !line.lists_plugins);
    // A library named by --plugin was refused: do not go on without it.
    for (size_t i = 0; line.refused_plugin_is_fatal && i < plugins.records().size(); ++i)
        for (const std::string& named : line.common.plugin_files)
            if (plugins.records()[i].path == named && !plugins.records()[i].plugin)
                throw Error(Exit::usage, "--plugin " + named + ": the library was refused, see above; nothing was done");
    return plugins;
}

int run(int argc, char** argv) {
    const CommandLine line = parse_command_line(argc, argv);
    if (!line.command) return static_cast<int>(Exit::done);
    set_up_log(line.common);
    if (!line.common.timeline_file.empty()) timeline::record(line.common.timeline_file);
    const PluginRegistry plugins = line.needs_plugins ? find_plugins(line) : PluginRegistry();
    return line.command(plugins);
}

int fail(Exit code, const std::string& message, const std::string& details = {}) {
    // The user's Ctrl-C is not an error, even if it made something fail.
    if (interrupted()) {
        log(LogLevel::warning, "interrupted: nothing more is written");
        return static_cast<int>(Exit::interrupted);
    }
    log(LogLevel::error, message);
    if (!details.empty()) log(LogLevel::info, details);
    return static_cast<int>(code);
}

// Runs `work` and returns its exit code, or that of the exception that it ends with.
template <class Work>
int reported(const Work& work) {
    try {
        return work();
    } catch (const Error& e) {
        return fail(e.code(), e.what(), e.details());
    } catch (const std::bad_alloc&) {
        return fail(Exit::failed, "out of memory: close other programs, or take a smaller scene or picture");
    } catch (const std::exception& e) {
        return fail(Exit::failed, std::string("unexpected failure: ") + e.what());
    }
}

// What is written when the command is done: the timeline, and the last of stdout. A log that ended early is a failure, too.
int finish() {
    timeline::write();
    errno = 0;
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
        throw Error(Exit::failed,
                    std::string("stdout cannot be written: ") +
                        (errno ? std::strerror(errno) : "a disk that is full, or a reader that has gone, took a part of it"));
    return static_cast<int>(log_file_failed() ? Exit::failed : Exit::done);
}

// Opens what the caller has closed of stdin, stdout and stderr, for reading alone. Otherwise the next file that is opened would
// take that number, and get what is printed; so printing fails, as on a closed file.
void hold_standard_files() {
    for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(number, F_GETFD) < 0) (void)!open("/dev/null", O_RDONLY);
}

// All that this program does in workers.
const std::vector<const worker::JobKind*> kJobs = {&import::kImportJob, &check::kCheckJob, &kBuildJob,      &kCompileJob,
                                                   &trial_worker(),     &kLoadJob,         &lab::kToolsJob, &lab::kMeasureJob};

}  // namespace
}  // namespace clarity

int main(int argc, char** argv) {
    // Workers must set their resource limits before anything else runs.
    if (const clarity::worker::JobKind* job = clarity::worker::kind_of_worker(argc, argv, clarity::kJobs))
        return clarity::worker::worker_main(*job, argc, argv);
    clarity::hold_standard_files();
    int code = clarity::reported([&] { return clarity::run(argc, argv); });
    if (const int end = clarity::reported(clarity::finish); code == 0) code = end;
    // After a failure a launch may still be running. PoCL's threads would crash when its library is unloaded around them; other
    // drivers may wait for a launch that never ends.
    if (code != 0 || clarity::any_never_released()) {
        std::fflush(nullptr);
        clarity::leave_process_folders();
        std::_Exit(code);
    }
    return code;
}
