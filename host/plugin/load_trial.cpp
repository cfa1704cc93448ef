#include "plugin/load_trial.hpp"

#include <dlfcn.h>

#include <filesystem>

#include "plugin/registry.hpp"
#include "plugin/trust.hpp"
#include "worker/child.hpp"

namespace clarity {
namespace {

constexpr const char* kAdvice = "; the file may be damaged: build it or copy it again";

void load(ParcelReader& arguments) {
    const auto library = worker::arguments_in<std::string>(arguments);
    load_plugin(library);  // the parent finds out itself why a library is refused
    // Its destructors would run at the end of the program.
    const std::string full = std::filesystem::absolute(library).string();
    if (void* const handle = dlopen(full.c_str(), RTLD_NOW | RTLD_NOLOAD)) {
        dlclose(handle);
        dlclose(handle);  // what load_plugin() holds
    }
}

}  // namespace

const worker::JobKind kLoadJob = {
    "load",
    "to look at a plugin, run `clarity plugins --plugin FILE`",
    Exit::failed,
    true,
    LogLevel::debug,
    {"crashed the process that opened it ({how}){advice}", "ended the process that opened it ({how}){advice}",
     "did not let the process that opened it go on for {how}{advice}", "was being opened when that process was killed{advice}",
     "took more than {how} of memory when it was opened{advice}", "was being opened when that process was killed{advice}"},
    load};

Problem try_to_load(const std::string& path) {
    if (worker::in_worker() || trust_of(path) != Trust::none) return {};
    worker::Job job(kLoadJob, "a library that was opened", {10, 0, uint64_t(4) << 30});
    job.advice = kAdvice;
    job.subject = path;
    try {
        Progress progress;
        job.run(path, progress);
    } catch (const worker::JobDied& died) {
        return died.what();
    } catch (const std::exception& e) {
        log(LogLevel::debug, path + ": is opened without a trial: " + e.what());
    }
    return {};
}

}  // namespace clarity
