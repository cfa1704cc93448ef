// worker_main.cpp -- main function of the worker process: loads the importers, enters the sandbox, imports, and leaves the
// scene in shared memory.
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <mutex>
#include <new>

#include "base/error.hpp"
#include "base/log.hpp"
#include "import/import.hpp"
#include "import/sandbox.hpp"
#include "import/scene_builder.hpp"
#include "import/wire.hpp"
#include "import/worker_channel.hpp"

namespace clarity::import {
namespace {

// ---- cause of death: reported by the worker where the parent cannot see it from outside

// Sanitizers handle crashes themselves and report more.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kHasCrashReports = true;
#else
constexpr bool kHasCrashReports = false;
#endif

alignas(16) char signal_stack[64 << 10];

void on_crash(int signal, siginfo_t* info, void* context) {
    uintptr_t stack_pointer = 0;
#if defined(__x86_64__)
    stack_pointer = static_cast<uintptr_t>(static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_RSP]);
#elif defined(__aarch64__)
    stack_pointer = static_cast<uintptr_t>(static_cast<ucontext_t*>(context)->uc_mcontext.sp);
#else
    (void)context;
#endif
    const auto address = reinterpret_cast<uintptr_t>(info->si_addr);
    const uintptr_t distance = address > stack_pointer ? address - stack_pointer : stack_pointer - address;
    if (stack_pointer != 0 && distance < (1u << 20)) send_short(kChannelFd, MessageKind::death, "stack overflow");
    // After the return the faulty access repeats, now without a handler.
    std::signal(signal, SIG_DFL);
}

[[noreturn]] void on_terminate() {
    try {
        if (std::current_exception()) std::rethrow_exception(std::current_exception());
    } catch (const std::bad_alloc&) {
        send_short(kChannelFd, MessageKind::death, "out of memory");
    } catch (const std::exception& e) {
        send_short(kChannelFd, MessageKind::death, e.what());
    } catch (...) {
    }
    std::abort();
}

// Sent once. The code that asked for memory may survive the refusal; if the worker dies instead, this was the reason.
void on_out_of_memory() {
    static bool said = false;
    if (!said) send_short(kChannelFd, MessageKind::death, "out of memory");
    said = true;
    throw std::bad_alloc();
}

void prepare_last_words() {
    std::set_terminate(on_terminate);
    std::set_new_handler(on_out_of_memory);
    if (kHasCrashReports) return;
    const stack_t stack = {signal_stack, 0, sizeof signal_stack};
    sigaltstack(&stack, nullptr);
    struct sigaction action {};
    action.sa_sigaction = on_crash;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    for (const int signal : {SIGSEGV, SIGBUS}) sigaction(signal, &action, nullptr);
}

// ---- messages to the parent

class ChannelProgress : public Progress, public ImportObserver {
 public:
    void stage(const std::string& text) override { send(MessageKind::stage, 0, text); }
    // Importers report as often as they like; at most forty reports a second are sent to the parent.
    bool report(float fraction) override {
        const std::lock_guard<std::mutex> lock(mutex_);
        const auto now = std::chrono::steady_clock::now();
        if (now - last_look_ < std::chrono::milliseconds(25)) return !cancelled();
        last_look_ = now;
        Message message;
        while (!cancelled()) {
            const Received received = receive_message(kChannelFd, message);
            if (received == Received::nothing) break;
            if (received == Received::closed || message.kind == MessageKind::cancel) cancel();
        }
        send(MessageKind::progress, fraction, {});
        return !cancelled();
    }
    void running(const std::string& file, const std::string& importer) override {
        send(MessageKind::running, 0, file + '\n' + importer);
        Message answer;
        do {
            pollfd ready = {kChannelFd, POLLIN, 0};
            poll(&ready, 1, -1);
            if (receive_message(kChannelFd, answer) == Received::closed) _exit(1);
            if (answer.kind == MessageKind::cancel) throw Cancelled();
        } while (answer.kind != MessageKind::proceed);
    }

 private:
    static void send(MessageKind kind, float fraction, const std::string& text) {
        send_message(kChannelFd, {kind, 0, fraction, text});
    }
    std::mutex mutex_;
    std::chrono::steady_clock::time_point last_look_{};
};

void send_log(LogLevel level, const std::string& text) {
    send_message(kChannelFd, {MessageKind::log, static_cast<int32_t>(level), 0, text});
}

struct Arguments {
    WorkerLimits limits;
    std::vector<std::string> plugins, search_paths, files;
    long parent = 0;
};

// import-worker [--memory BYTES] [--most-memory BYTES] [--cpu SECONDS] [--parent PID] [--plugin FILE]... [--search FOLDER]...
// -- FILE...
bool parse(int argc, char** argv, Arguments& arguments) {
    int i = 1;
    if (i < argc && std::strcmp(argv[i], "import-worker") == 0) ++i;
    for (; i + 1 < argc && std::strcmp(argv[i], "--") != 0; i += 2) {
        const std::string key = argv[i], value = argv[i + 1];
        if (key == "--memory") {
            arguments.limits.memory_bytes = std::strtoull(value.c_str(), nullptr, 10);
        } else if (key == "--most-memory") {
            arguments.limits.most_memory_bytes = std::strtoull(value.c_str(), nullptr, 10);
        } else if (key == "--cpu") {
            arguments.limits.cpu_s = std::strtoull(value.c_str(), nullptr, 10);
        } else if (key == "--parent") {
            arguments.parent = std::strtol(value.c_str(), nullptr, 10);
        } else if (key == "--plugin") {
            arguments.plugins.push_back(value);
        } else if (key == "--search") {
            arguments.search_paths.push_back(value);
        } else {
            return false;
        }
    }
    if (i >= argc || std::strcmp(argv[i], "--") != 0) return false;
    for (++i; i < argc; ++i) arguments.files.push_back(argv[i]);
    return !arguments.files.empty();
}

std::string import_files(const Arguments& arguments, ChannelProgress& progress) {
    const FileAccess access(arguments.files, arguments.search_paths);
    const PluginRegistry plugins = PluginRegistry::of(arguments.plugins);
    // A file that the user named may be a link to another folder. Only the target itself may be read, not the files beside it.
    std::vector<std::string> named;
    for (const std::string& file : arguments.files) named.push_back(std::filesystem::canonical(file).string());
    for (const std::string& note : enter_sandbox(access.folders(), named, arguments.limits)) {
        log(LogLevel::debug, "import worker: " + note);
    }
    SceneBuilder builder(plugins, access, progress, &progress);
    for (const std::string& file : arguments.files) builder.add_root(file);
    const Scene scene = builder.take();
    allow_writing_result();
    const std::string why = write_scene(kResultFd, scene);
    return why.empty() ? why : arguments.files.front() + ": " + why;
}

int run(const Arguments& arguments) {
    ChannelProgress progress;
    std::string why;
    try {
        why = import_files(arguments, progress);
    } catch (const std::bad_alloc&) {
        why = arguments.files.front() + ": out of memory";
    } catch (const std::exception& e) {
        why = e.what();
    }
    if (why.empty()) {
        send_message(kChannelFd, {MessageKind::done, 0, 0, {}});
    } else {
        send_message(kChannelFd, {MessageKind::failed, 0, 0, why});
    }
    return why.empty() ? 0 : static_cast<int>(Exit::import_failed);
}

}  // namespace

int import_worker_main(int argc, char** argv) {
    Arguments arguments;
    if (!parse(argc, argv, arguments) || fcntl(kChannelFd, F_GETFD) < 0 || fcntl(kResultFd, F_GETFD) < 0) {
        std::fprintf(stderr, "import-worker is started by clarity itself; to import a file, run `clarity info FILE`\n");
        return static_cast<int>(Exit::usage);
    }
    // The kernel ends the worker when its parent dies, because the result is of no use then. The check after the call covers a
    // parent that died before it.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (arguments.parent != 0 && getppid() != arguments.parent) _exit(1);
#ifdef SYS_close_range
    syscall(SYS_close_range, kResultFd + 1, ~0u, 0);
#endif
    std::signal(SIGPIPE, SIG_IGN);
    set_log_level(LogLevel::error);
    set_log_listener(send_log);
    prepare_last_words();
    send_message(kChannelFd, {MessageKind::greeting, 0, 0, kWorkerGreeting});
    const int status = run(arguments);
    // Exit without destructors: the kernel frees memory faster, and the clean-up of a library could still crash.
    _exit(status);
}

}  // namespace clarity::import
