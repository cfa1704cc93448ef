// build_worker_main.cpp -- main function of the worker process that runs one build of a stranger's library.
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/scoped_fp_mode.hpp"
#include "plugin/registry.hpp"
#include "render/accel/build_in_worker.hpp"
#include "render/accel/builder_wire.hpp"
#include "worker/child.hpp"
#include "worker/sandbox.hpp"

namespace clarity {
namespace {

using worker::MessageKind;

struct Arguments {
    std::string library;
    uint64_t memory_bytes = 0;
    long parent = 0;
};

// build-worker --library FILE --memory BYTES --parent PID
bool parse(int argc, char** argv, Arguments& arguments) {
    for (int i = 2; i + 1 < argc; i += 2) {
        const std::string key = argv[i];
        if (key == "--library")
            arguments.library = argv[i + 1];
        else if (key == "--memory")
            arguments.memory_bytes = std::strtoull(argv[i + 1], nullptr, 10);
        else if (key == "--parent")
            arguments.parent = std::strtol(argv[i + 1], nullptr, 10);
        else
            return false;
    }
    return !arguments.library.empty();
}

// The parent says `proceed` when the input is complete.
void wait_for_input() {
    worker::Message message;
    do {
        pollfd ready = {worker::kChannelFd, POLLIN, 0};
        poll(&ready, 1, -1);
        if (receive_message(worker::kChannelFd, message) == worker::Received::closed) _exit(1);
        if (message.kind == MessageKind::cancel) throw Cancelled();
    } while (message.kind != MessageKind::proceed);
}

void build(const Arguments& arguments) {
    const PluginRecord record = load_plugin(arguments.library);
    if (!record.plugin || !record.plugin->accel)
        throw Error(Exit::failed, "the library is no structure any more: " + record.why);
    const rt_plugin& plugin = *record.plugin;
    wait_for_input();
    std::unique_ptr<BuilderInput> input;
    std::string why = read_builder_input(worker::kResultFd, input);
    if (!why.empty()) throw Error(Exit::failed, why);
    worker::WorkerLimits limits;
    limits.memory_bytes = limits.most_memory_bytes = arguments.memory_bytes;
    for (const std::string& note : worker::enter_sandbox(worker::WorkerKind::builder, {}, {}, limits))
        log(LogLevel::debug, "build worker: " + note);

    worker::ChannelProgress progress;
    HostServices services({}, progress);  // without a name: the parent says which builder it is
    GuardedOutput output(plugin, input->group_count, services);
    const rt_build_input& table = input->table();
    services.check(static_cast<int>(Exit::failed), [&] {
        const ScopedFpMode floats;
        return run_builder(plugin, services.host(), &table, input->tree(), output.table());
    });
    const std::string overrun = overrun_of(output.result());
    if (!overrun.empty())
        throw Error(Exit::failed, "the builder wrote beyond the end of " + overrun + "; this is a fault of the plugin");
    worker::allow_writing_result();
    why = write_builder_result(worker::kResultFd, output.result());
    if (!why.empty()) throw Error(Exit::failed, why);
}

}  // namespace

int build_worker_main(int argc, char** argv) {
    Arguments arguments;
    constexpr const char* instead = "to build a structure, run `clarity render`";
    if (!parse(argc, argv, arguments)) {
        std::fprintf(stderr, "workers are started by clarity itself; %s\n", instead);
        return static_cast<int>(Exit::usage);
    }
    if (!worker::begin_worker(worker::kBuildGreeting, arguments.parent, instead)) return static_cast<int>(Exit::usage);
    worker::Message last{MessageKind::done, 0, 0, {}};
    try {
        build(arguments);
    } catch (const Cancelled&) {
        last.kind = MessageKind::cancelled;
    } catch (const std::exception& e) {
        last.kind = MessageKind::failed;
        last.text = e.what();
    }
    std::fflush(nullptr);  // what the builder printed comes before the end
    worker::send_message(worker::kChannelFd, last);
    _exit(last.kind == MessageKind::done ? 0 : 1);
}

}  // namespace clarity
