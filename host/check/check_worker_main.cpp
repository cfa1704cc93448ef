// check_worker_main.cpp -- main function of the worker: loads one library and runs checks of one phase, one after the other.
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
#include "check/builds/build_checks.hpp"
#include "check/builds/device_checks.hpp"
#include "check/check.hpp"
#include "check/hits/hits_checks.hpp"
#include "check/hits/own_scene.hpp"
#include "check/importers/import_checks.hpp"
#include "check/process_size.hpp"
#include "check/shapes/key_checks.hpp"
#include "check/shapes/shape_checks.hpp"
#include "device/device.hpp"
#include "import/wire.hpp"
#include "render/tracers/rays/ray_text.hpp"
#include "worker/child.hpp"
#include "worker/sandbox.hpp"

namespace clarity::check {
namespace {

using worker::kChannelFd;
using worker::MessageKind;

constexpr uint64_t kBuilderBytes = uint64_t(1) << 30;  // for scenes of at most 70000 triangles
constexpr uint64_t kLargeBuilderBytes = uint64_t(3) << 30;
constexpr uint64_t kImporterBytes = uint64_t(1) << 30;  // what the program gives to small files
constexpr size_t kMostText = 3000;
constexpr rlim_t kAloneLimit_s = 4;  // processor time for a sample that is read alone; of larger ones nothing is compared then

struct Arguments {
    std::string library, phase, device, report, truth, scratch, rays;
    std::vector<std::string> beside, samples;
    std::vector<std::string> only;
    std::set<std::string> done;  // checks that an earlier worker ran
    std::vector<int> lanes;
    bool quick = false, large = false, list = false, stop_at_first = false;
    uint64_t seed = 0;
    long parent = 0;
};

// check-worker KEY VALUE... The program gives the scene to --rays in the file kResultFd.
bool parse(int argc, char** argv, Arguments& arguments) {
    Arguments& a = arguments;
    const auto text = [](std::string& to) { return [&to](const char* value) { to = value; }; };
    const auto list = [](auto& to) { return [&to](const char* value) { to.insert(to.end(), value); }; };
    const auto flag = [](bool& to) { return [&to](const char* value) { to = value == std::string("1"); }; };
    const std::map<std::string, std::function<void(const char*)>> keys = {
        {"--library", text(a.library)},
        {"--beside", list(a.beside)},
        {"--phase", text(a.phase)},  // builds, hits, keys, shape, accesses or imports
        {"--quick", flag(a.quick)},
        {"--large", flag(a.large)},
        {"--list", flag(a.list)},
        {"--stop", flag(a.stop_at_first)},
        {"--seed", [&](const char* value) { a.seed = std::strtoull(value, nullptr, 10); }},
        {"--device", text(a.device)},
        {"--report", text(a.report)},
        {"--lanes", [&](const char* value) { a.lanes.push_back(std::atoi(value)); }},
        {"--only", list(a.only)},
        {"--done", list(a.done)},
        {"--sample", list(a.samples)},
        {"--truth", text(a.truth)},
        {"--scratch", text(a.scratch)},
        {"--rays", text(a.rays)},
        {"--parent", [&](const char* value) { a.parent = std::strtol(value, nullptr, 10); }},
    };
    for (int i = 2; i + 1 < argc; i += 2) {
        const auto key = keys.find(argv[i]);
        if (key == keys.end()) return false;
        key->second(argv[i + 1]);
    }
    return !arguments.library.empty() && !arguments.phase.empty();
}

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
                                   {"seconds", seconds}};
    worker::send_message(kChannelFd,
                         {MessageKind::report, 0, 0, report.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)});
}

Outcome::Kind run(const Check& check) {
    const auto start = std::chrono::steady_clock::now();
    const Step step = [&](const std::string& what, double limit_s) {
        worker::take_crash_signals();
        worker::send_message(
            kChannelFd, {MessageKind::running, 0, static_cast<float>(limit_s), check.name + '\n' + check.tried + '\n' + what});
    };
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

void enter_sandbox(WorkerKind kind, const std::vector<std::string>& folders, const worker::WorkerLimits& limits) {
    for (const std::string& note : worker::enter_sandbox(kind, folders, {}, limits))
        log(LogLevel::debug, "check worker: " + note);
}
worker::WorkerLimits limits_of(uint64_t memory_bytes) {
    worker::WorkerLimits limits;
    limits.memory_bytes = limits.most_memory_bytes = memory_bytes;
    return limits;
}
std::string own_folder() {  // tells how large this process is
    return "/proc/" + std::to_string(getpid());
}

std::vector<Check> builder_checks(const PluginRecord& record, const Arguments& arguments) {
    use_one_arena();
    enter_sandbox(WorkerKind::builder, {own_folder()}, limits_of(arguments.large ? kLargeBuilderBytes : kBuilderBytes));
    return build_checks(*record.plugin, arguments.quick, arguments.seed, arguments.large);
}

// The first structure among the libraries beside a shape; nullptr: none.
const rt_plugin* structure_beside(const Arguments& arguments) {
    for (const std::string& library : arguments.beside)
        if (const PluginRecord beside = load_plugin(library); beside.plugin && beside.plugin->accel) return beside.plugin;
    return nullptr;
}

std::vector<Check> kernel_checks(const PluginRecord& record, const Arguments& arguments) {
    const rt_plugin* layout = nullptr;
    if (record.plugin->primitive) layout = structure_beside(arguments);
    for (const std::string& library : arguments.beside) {
        if (record.plugin->primitive) break;
        const PluginRecord beside = load_plugin(library);
        if (!beside.plugin) throw Error(Exit::failed, beside.path + ": " + beside.why);
        layout = beside.plugin;
    }
    std::vector<rt_ray> rays;
    Scene scene;
    if (!arguments.rays.empty() && !arguments.list) {
        rays = read_rays(arguments.rays);
        if (const std::string why = import::read_scene(worker::kResultFd, scene); !why.empty()) throw Error(Exit::failed, why);
    }
    enter_sandbox(WorkerKind::driver, {}, {});
    HitsOptions options;
    options.quick = arguments.quick;
    options.seed = arguments.seed;
    options.large = arguments.large;
    options.report_folder = arguments.report;
    options.lanes_are_named = !arguments.lanes.empty();
    if (options.lanes_are_named) options.lanes = arguments.lanes;
    const std::string device = arguments.device;
    const auto open = [device] { return std::make_shared<Device>(choose_device(device)); };
    if (record.plugin->primitive && arguments.lanes.empty() && arguments.quick) options.lanes = {1, 16};
    if (record.plugin->primitive)
        return arguments.phase == "accesses" ? shape_access_checks(*record.plugin, open, options)
                                             : shape_checks(*record.plugin, layout, open, options);
    if (arguments.phase == "accesses") return access_checks(*record.plugin, layout, open, options);
    std::vector<Check> checks = hits_checks(*record.plugin, layout, open, options);
    checks.insert(checks.begin(), device_check(*record.plugin, open, arguments.quick));
    if (!arguments.rays.empty())
        checks.push_back(own_scene_check({*record.plugin, layout, open, options}, std::move(scene), rays));
    return checks;
}

std::vector<Check> key_value_checks(const Arguments& arguments) {
    const auto inputs = std::make_shared<KeyInputs>();
    std::vector<std::string> libraries = {arguments.library};
    libraries.insert(libraries.end(), arguments.beside.begin(), arguments.beside.end());
    inputs->plugins = PluginRegistry::of(libraries);
    inputs->plugin = inputs->plugins.records().front().plugin;
    inputs->statements = write_statements(*inputs->plugin, arguments.scratch, arguments.seed);
    inputs->seed = arguments.seed;
    set_log_listener([](LogLevel, const std::string&) {});  // warnings about wrong statements are as they should be
    use_one_arena();
    enter_sandbox(WorkerKind::parser, {own_folder(), std::filesystem::canonical(arguments.scratch).string()},
                  limits_of(kImporterBytes));
    return key_checks(inputs, arguments.quick);
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

std::vector<Check> importer_checks(const Arguments& arguments) {
    const auto inputs = std::make_shared<ImportInputs>();
    std::vector<std::string> libraries = {arguments.library};
    libraries.insert(libraries.end(), arguments.beside.begin(), arguments.beside.end());
    inputs->plugins = PluginRegistry::of(libraries);
    inputs->plugin = inputs->plugins.records().front().plugin;
    const rt_importer& importer = *inputs->plugin->importer;
    inputs->seed = arguments.seed;
    inputs->samples = samples_among(importer, arguments.samples);
    for (const std::string& sample : inputs->samples)
        if (const auto truth = truth_of(sample, arguments.truth)) inputs->truths[sample] = *truth;
    inputs->hostile = write_hostile_files(importer, inputs->samples, arguments.scratch,
                                          arguments.list    ? 0
                                          : arguments.quick ? 100
                                                            : 600,
                                          arguments.seed);
    set_log_listener([](LogLevel, const std::string&) {});  // warnings about damaged files are as they should be
    use_one_arena();
    std::vector<std::string> folders = {own_folder(), std::filesystem::canonical(arguments.scratch).string()};
    for (const std::string& sample : inputs->samples) folders.push_back(std::filesystem::path(sample).parent_path().string());
    if (!arguments.list && is_wanted("imports.state", arguments.only) && !arguments.done.count("imports.state"))
        for (size_t i = 0; i < std::min(inputs->samples.size(), kMostAlone); ++i) {
            const std::string& sample = inputs->samples[i];
            const auto digest = in_copy(kAloneLimit_s, [&] {
                enter_sandbox(WorkerKind::parser, folders, limits_of(kImporterBytes));
                return import_digest(*inputs, sample);
            });
            if (digest) inputs->alone[sample] = *digest;
        }
    enter_sandbox(WorkerKind::parser, folders, limits_of(kImporterBytes));
    return import_checks(inputs, arguments.quick);
}

int run_all(const Arguments& arguments) {
    // The library was loaded by the program before, to read its description; its constructors have run there.
    const PluginRecord record = load_plugin(arguments.library);
    if (!record.plugin) throw Error(Exit::failed, record.why);
    const std::vector<Check> checks = arguments.phase == "builds"    ? builder_checks(record, arguments)
                                      : arguments.phase == "imports" ? importer_checks(arguments)
                                      : arguments.phase == "keys"    ? key_value_checks(arguments)
                                                                     : kernel_checks(record, arguments);
    for (const Check& check : checks) {
        if (arguments.done.count(check.name) || !is_wanted(check.name, arguments.only)) continue;
        if (arguments.list)
            report(check, Outcome::skipped(""), 0);
        else if (run(check) == Outcome::Kind::failed && arguments.stop_at_first)
            break;
    }
    worker::send_message(kChannelFd, {MessageKind::done, 0, 0, {}});
    return 0;
}

}  // namespace

int check_worker_main(int argc, char** argv) {
    Arguments arguments;
    constexpr const char* instead = "to check a plugin, run `clarity check PLUGIN`";
    if (!parse(argc, argv, arguments)) {
        std::fprintf(stderr, "workers are started by clarity itself; %s\n", instead);
        return static_cast<int>(Exit::usage);
    }
    if (!worker::begin_worker(worker::kCheckGreeting, arguments.parent, instead)) return static_cast<int>(Exit::usage);
    int status = 1;
    try {
        status = run_all(arguments);
    } catch (const std::exception& e) {
        worker::send_message(kChannelFd, {MessageKind::failed, 0, 0, arguments.library + ": " + e.what()});
    }
    // Exit without destructors: a plugin or a driver may crash in them, which says nothing about the checks.
    _exit(status);
}

}  // namespace clarity::check
