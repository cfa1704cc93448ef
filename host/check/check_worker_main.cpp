// check_worker_main.cpp -- main function of the worker: loads one library and runs checks of one phase, one after the other.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <set>

#include <nlohmann/json.hpp>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "check/builds/build_checks.hpp"
#include "check/builds/device_checks.hpp"
#include "check/check.hpp"
#include "check/hits/hits_checks.hpp"
#include "check/importers/import_checks.hpp"
#include "check/process_size.hpp"
#include "check/shapes/key_checks.hpp"
#include "check/shapes/shape_checks.hpp"
#include "device/device.hpp"
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

struct Arguments {
    std::string library, phase, device, report, truth, scratch;
    std::vector<std::string> beside, samples;
    std::vector<std::string> only;
    std::set<std::string> done;  // checks that an earlier worker ran
    std::vector<int> lanes;
    bool quick = false, large = false;
    long parent = 0;
};

// check-worker --library FILE [--beside FILE]... --phase builds|hits|keys|shape|accesses|imports [--quick 1] [--device D]
// [--report DIR]
// [--lanes N]...
// [--only NAME]...
// [--done NAME]... [--sample FILE|DIR]... [--truth DIR] [--scratch DIR]
bool parse(int argc, char** argv, Arguments& arguments) {
    for (int i = 2; i + 1 < argc; i += 2) {
        const std::string key = argv[i], value = argv[i + 1];
        if (key == "--library") {
            arguments.library = value;
        } else if (key == "--beside") {
            arguments.beside.push_back(value);
        } else if (key == "--sample") {
            arguments.samples.push_back(value);
        } else if (key == "--truth") {
            arguments.truth = value;
        } else if (key == "--scratch") {
            arguments.scratch = value;
        } else if (key == "--phase") {
            arguments.phase = value;
        } else if (key == "--quick") {
            arguments.quick = value == "1";
        } else if (key == "--large") {
            arguments.large = value == "1";
        } else if (key == "--device") {
            arguments.device = value;
        } else if (key == "--report") {
            arguments.report = value;
        } else if (key == "--only") {
            arguments.only.push_back(value);
        } else if (key == "--lanes") {
            arguments.lanes.push_back(std::atoi(value.c_str()));
        } else if (key == "--done") {
            arguments.done.insert(value);
        } else if (key == "--parent") {
            arguments.parent = std::strtol(value.c_str(), nullptr, 10);
        } else {
            return false;
        }
    }
    return !arguments.library.empty() && !arguments.phase.empty();
}

std::string shortened(std::string text) {
    if (text.size() > kMostText) text = text.substr(0, kMostText) + " ...";
    return text;
}

void run(const Check& check) {
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
    constexpr const char* kKinds[] = {"passed", "failed", "skipped"};
    const nlohmann::json report = {{"name", check.name},
                                   {"tried", check.tried},
                                   {"kind", kKinds[static_cast<int>(outcome.kind)]},
                                   {"found", shortened(outcome.found)},
                                   {"repeat", outcome.repeat},
                                   {"seconds", seconds_since(start)}};
    worker::send_message(kChannelFd,
                         {MessageKind::report, 0, 0, report.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)});
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
    return build_checks(*record.plugin, arguments.quick, 0, arguments.large);
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
    enter_sandbox(WorkerKind::driver, {}, {});
    HitsOptions options;
    options.quick = arguments.quick;
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
    return checks;
}

std::vector<Check> key_value_checks(const Arguments& arguments) {
    const auto inputs = std::make_shared<KeyInputs>();
    std::vector<std::string> libraries = {arguments.library};
    libraries.insert(libraries.end(), arguments.beside.begin(), arguments.beside.end());
    inputs->plugins = PluginRegistry::of(libraries);
    inputs->plugin = inputs->plugins.records().front().plugin;
    inputs->statements = write_statements(*inputs->plugin, arguments.scratch);
    set_log_listener([](LogLevel, const std::string&) {});  // warnings about wrong statements are as they should be
    use_one_arena();
    enter_sandbox(WorkerKind::parser, {own_folder(), std::filesystem::canonical(arguments.scratch).string()},
                  limits_of(kImporterBytes));
    return key_checks(inputs, arguments.quick);
}

std::vector<Check> importer_checks(const Arguments& arguments) {
    const auto inputs = std::make_shared<ImportInputs>();
    std::vector<std::string> libraries = {arguments.library};
    libraries.insert(libraries.end(), arguments.beside.begin(), arguments.beside.end());
    inputs->plugins = PluginRegistry::of(libraries);
    inputs->plugin = inputs->plugins.records().front().plugin;
    const rt_importer& importer = *inputs->plugin->importer;
    inputs->samples = samples_among(importer, arguments.samples);
    for (const std::string& sample : inputs->samples)
        if (const auto truth = truth_of(sample, arguments.truth)) inputs->truths[sample] = *truth;
    inputs->hostile = write_hostile_files(importer, inputs->samples, arguments.scratch, arguments.quick ? 100 : 600);
    set_log_listener([](LogLevel, const std::string&) {});  // warnings about damaged files are as they should be
    use_one_arena();
    std::vector<std::string> folders = {own_folder(), std::filesystem::canonical(arguments.scratch).string()};
    for (const std::string& sample : inputs->samples) folders.push_back(std::filesystem::path(sample).parent_path().string());
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
    for (const Check& check : checks)
        if (!arguments.done.count(check.name) && is_wanted(check.name, arguments.only)) run(check);
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
