// check_job.cpp -- the work in the worker: loads one library and runs checks of one phase, one after the other.
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "device/device.hpp"
#include "stand/ray_text.hpp"
#include "tools/check/builds/build_checks.hpp"
#include "tools/check/builds/device_checks.hpp"
#include "tools/check/check.hpp"
#include "tools/check/hits/built_checks.hpp"
#include "tools/check/hits/hits_checks.hpp"
#include "tools/check/importers/import_checks.hpp"
#include "tools/check/process_size.hpp"
#include "tools/check/shapes/key_checks.hpp"
#include "tools/check/shapes/shape_checks.hpp"
#include "tools/check/surfaces/model_checks.hpp"
#include "worker/child.hpp"

namespace clarity::check {
namespace {

using worker::kChannelFd;
using worker::MessageKind;

constexpr uint64_t kBuilderBytes = uint64_t(1) << 30;  // for scenes of at most 70000 triangles
constexpr uint64_t kLargeBuilderBytes = uint64_t(3) << 30;
constexpr uint64_t kImporterBytes = uint64_t(1) << 30;  // what the program gives to small files
constexpr size_t kMostText = 3000;
constexpr rlim_t kAloneLimit_s = 4;  // processor time for a sample that is read alone; of larger ones nothing is compared then

std::string shortened(std::string text) {
    if (text.size() > kMostText) text = text.substr(0, kMostText) + " ...";
    return text;
}

void report(const Check& check, const Outcome& outcome, double seconds) {
    constexpr const char* kKinds[] = {"passed", "failed", "skipped"};
    const nlohmann::json report = {{"name", check.name},
                                   {"tried", check.tried},
                                   {"kind", kKinds[static_cast<int>(outcome.kind)]},
                                   {"found", shortened(outcome.found)},
                                   {"repeat", outcome.repeat},
                                   {"asked", static_cast<int>(outcome.asked)},
                                   {"seconds", seconds}};
    worker::send_message(kChannelFd,
                         {MessageKind::report, 0, 0, report.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)});
}

Outcome::Kind run(const Check& check) {
    const auto start = std::chrono::steady_clock::now();
    const Step step([&](const std::string& what, double limit_s, Asked asked) {
        worker::say_step(check.name + '\n' + check.tried + '\n' + std::to_string(static_cast<int>(asked)) + '\n' + what,
                         limit_s);
    });
    step("beginning", 10);
    Outcome outcome;
    try {
        outcome = check.run(step);
    } catch (const std::bad_alloc&) {
        outcome = Outcome::failed("out of memory");
    } catch (const Error& e) {
        outcome = Outcome::failed(shortened(std::string(e.what()) + (e.details().empty() ? "" : ": " + e.details())));
    } catch (const std::exception& e) {
        outcome = Outcome::failed(e.what());
    }
    report(check, outcome, seconds_since(start));
    return outcome.kind;
}

using worker::WorkerKind;

worker::WorkerLimits limits_of(uint64_t memory_bytes) {
    worker::WorkerLimits limits;
    limits.memory_bytes = limits.most_memory_bytes = memory_bytes;
    return limits;
}
std::string own_folder() {  // tells how large this process is
    return "/proc/" + std::to_string(getpid());
}

std::vector<Check> builder_checks(const PluginRecord& record, const CheckJob& job) {
    use_one_arena();
    if (job.closed.empty())
        worker::enter_sandbox(WorkerKind::builder, {own_folder()}, {},
                              limits_of(job.large ? kLargeBuilderBytes : kBuilderBytes));
    else
        worker::enter_sandbox(WorkerKind::driver);  // the builder has a worker of its own
    return build_checks(*record.plugin, job.quick, job.seed, job.large);
}

// The first structure among the libraries beside a shape; nullptr: none.
const rt_plugin* structure_beside(const CheckJob& job) {
    for (const std::string& library : job.beside)
        if (const PluginRecord beside = load_plugin(library); beside.plugin && beside.plugin->accel) return beside.plugin;
    return nullptr;
}

std::vector<Check> kernel_checks(const PluginRecord& record, const CheckJob& job) {
    const rt_plugin* layout = nullptr;
    if (record.plugin->primitive) layout = structure_beside(job);
    for (const std::string& library : job.beside) {
        if (record.plugin->primitive) break;
        const PluginRecord beside = load_plugin(library);
        if (!beside.plugin) throw Error(Exit::failed, beside.path + ": " + beside.why);
        layout = beside.plugin;
    }
    std::vector<rt_ray> rays;
    Scene scene;
    if (!job.scene.empty() && !job.list) {
        rays = read_rays(job.rays);
        scene = job.scene.front().scene;
    }
    worker::enter_sandbox(WorkerKind::driver);
    HitsOptions options;
    options.quick = job.quick;
    options.seed = job.seed;
    options.large = job.large;
    options.report_folder = job.report;
    options.lanes_are_named = !job.lanes.empty();
    if (options.lanes_are_named) options.lanes = job.lanes;
    const std::string device = job.device;
    const auto open = [device] { return std::make_shared<Device>(choose_device(device)); };
    if (record.plugin->primitive && job.lanes.empty() && job.quick) options.lanes = {1, 16};
    if (record.plugin->primitive)
        return job.phase == "accesses" ? shape_access_checks(*record.plugin, open, options)
                                       : shape_checks(*record.plugin, layout, open, options);
    if (job.phase == "accesses") return access_checks(*record.plugin, layout, open, options);
    std::vector<Check> checks = hits_checks(*record.plugin, layout, open, options);
    checks.insert(checks.begin(), device_check(*record.plugin, open, job.quick));
    if (!job.rays.empty()) checks.push_back(own_scene_check({*record.plugin, layout, open, options}, std::move(scene), rays));
    return checks;
}

std::vector<Check> surface_model_checks(const PluginRecord& record, const CheckJob& job) {
    worker::enter_sandbox(WorkerKind::driver);
    return model_checks(
        *record.plugin, [device = job.device] { return std::make_shared<Device>(choose_device(device)); }, job.quick, job.seed);
}

std::vector<Check> key_value_checks(const CheckJob& job) {
    const auto inputs = std::make_shared<KeyInputs>();
    std::vector<std::string> libraries = {job.library};
    libraries.insert(libraries.end(), job.beside.begin(), job.beside.end());
    inputs->plugins = PluginRegistry::of(libraries);
    inputs->plugin = inputs->plugins.records().front().plugin;
    inputs->statements = write_statements(*inputs->plugin, job.scratch, job.seed);
    inputs->seed = job.seed;
    set_log_listener([](LogLevel, const std::string&) {});  // warnings about wrong statements are as they should be
    use_one_arena();
    worker::enter_sandbox(WorkerKind::parser, {own_folder(), std::filesystem::canonical(job.scratch).string()}, {},
                          limits_of(kImporterBytes));
    return key_checks(inputs, job.quick);
}

// Calls a function in a copy of this process, with a limit of processor time in seconds. Nothing where it crashes or takes
// longer: that is a result of other checks.
std::optional<std::string> in_copy(rlim_t limit_s, const std::function<std::string()>& call) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
    const pid_t copy = fork();
    if (copy == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        // The handlers would tell the program of a crash.
        for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGSYS}) std::signal(signal, SIG_DFL);
        const rlimit limit{limit_s, limit_s};
        setrlimit(RLIMIT_CPU, &limit);
        std::string said;
        try {
            said = call();
        } catch (...) {
            _exit(1);
        }
        _exit(write(ends[1], said.data(), said.size()) == static_cast<ssize_t>(said.size()) ? 0 : 1);
    }
    close(ends[1]);
    std::string said;
    char bytes[4096];
    for (ssize_t count = 0; copy > 0 && (count = read(ends[0], bytes, sizeof bytes)) > 0;)
        said.append(bytes, static_cast<size_t>(count));
    close(ends[0]);
    int status = 1;
    if (copy > 0)
        while (waitpid(copy, &status, 0) < 0 && errno == EINTR) {
        }
    return status == 0 ? std::optional<std::string>(said) : std::nullopt;
}

std::vector<Check> importer_checks(const CheckJob& job) {
    const auto inputs = std::make_shared<ImportInputs>();
    std::vector<std::string> libraries = {job.library};
    libraries.insert(libraries.end(), job.beside.begin(), job.beside.end());
    inputs->plugins = PluginRegistry::of(libraries);
    inputs->plugin = inputs->plugins.records().front().plugin;
    const rt_importer& importer = *inputs->plugin->importer;
    inputs->seed = job.seed;
    inputs->samples = samples_among(importer, job.samples);
    for (const std::string& sample : inputs->samples)
        if (const auto truth = truth_of(sample, job.truth)) inputs->truths[sample] = *truth;
    inputs->hostile = write_hostile_files(importer, inputs->samples, job.scratch,
                                          job.list    ? 0
                                          : job.quick ? 100
                                                      : 600,
                                          job.seed);
    set_log_listener([](LogLevel, const std::string&) {});  // warnings about damaged files are as they should be
    use_one_arena();
    std::vector<std::string> folders = {own_folder(), std::filesystem::canonical(job.scratch).string()};
    for (const std::string& sample : inputs->samples) folders.push_back(std::filesystem::path(sample).parent_path().string());
    if (!job.list && is_wanted("imports.state", job.only) && !job.done.count("imports.state"))
        for (size_t i = 0; i < std::min(inputs->samples.size(), kMostAlone); ++i) {
            const std::string& sample = inputs->samples[i];
            const auto digest = in_copy(kAloneLimit_s, [&] {
                worker::enter_sandbox(WorkerKind::parser, folders, {}, limits_of(kImporterBytes));
                return import_digest(*inputs, sample);
            });
            if (digest) inputs->alone[sample] = *digest;
        }
    worker::enter_sandbox(WorkerKind::parser, folders, {}, limits_of(kImporterBytes));
    return import_checks(inputs, job.quick);
}

void run_all(const CheckJob& job) {
    // The library was loaded by the program before, to read its description; its constructors have run there.
    PluginRecord record;
    if (job.closed.empty())
        record = load_plugin(job.library);
    else
        record.path = job.library, record.plugin = take_closed_builder(job.closed.front());
    if (!record.plugin) throw Error(Exit::failed, record.why);
    const std::vector<Check> checks = job.phase == "builds"    ? builder_checks(record, job)
                                      : job.phase == "imports" ? importer_checks(job)
                                      : job.phase == "keys"    ? key_value_checks(job)
                                      : job.phase == "surface" ? surface_model_checks(record, job)
                                                               : kernel_checks(record, job);
    for (const Check& check : checks) {
        if (job.done.count(check.name) || !is_wanted(check.name, job.only)) continue;
        if (job.list)
            report(check, Outcome::skipped(""), 0);
        else if (run(check) == Outcome::Kind::failed && job.stop_at_first)
            break;
    }
}

}  // namespace

void check_job(ParcelReader& arguments) {
    const auto job = worker::arguments_in<CheckJob>(arguments);
    try {
        run_all(job);
    } catch (const std::exception& e) {
        throw Error(Exit::failed, job.library + ": " + e.what());
    }
}

}  // namespace clarity::check
