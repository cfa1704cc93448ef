#include "worker/child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <new>

#include "base/error.hpp"
#include "base/log.hpp"

namespace clarity::worker {
namespace {

// AddressSanitizer handles crashes itself and reports more. (ThreadSanitizer's handler would need what the sandbox refuses.)
#ifdef __SANITIZE_ADDRESS__
constexpr bool kHasCrashReports = true;
#else
constexpr bool kHasCrashReports = false;
#endif

alignas(16) char signal_stack[64 << 10];

// Read by the signal handler, so it is plain memory.
struct Named {
    std::atomic<uintptr_t> begin{0};
    size_t bytes = 0, element_bytes = 0;
    char name[64] = {};
};
Named named[kMostNamed];
std::mutex named_mutex;
// Bytes beside a range within which an access is blamed on the range: as many as guards have (GuardedBytes), and, if there is
// no other cause, as an index of 32 bits may reach from the range before.
constexpr uintptr_t kNear = uintptr_t(8) << 30, kFar = uintptr_t(1) << 40;

void append(char* text, size_t size, const char* more) {
    const size_t at = std::strlen(text);
    if (at + 1 < size) std::strncat(text, more, size - at - 1);
}
void append(char* text, size_t size, uintptr_t number) {
    char digits[24], *end = digits + sizeof digits - 1;
    *end = 0;
    do *--end = static_cast<char>('0' + number % 10);
    while ((number /= 10) != 0);
    append(text, size, end);
}

// Appends where an address is in terms of a range.
void append_place(char* text, size_t size, uintptr_t address, const Named& range) {
    const uintptr_t begin = range.begin, end = begin + range.bytes;
    append(text, size, "an access ");
    if (address >= begin && address < end) {
        append(text, size, "at byte ");
        append(text, size, address - begin);
        append(text, size, " of ");
    } else {
        append(text, size, address < begin ? begin - address : address - end + 1);
        append(text, size, address < begin ? " bytes before " : " bytes beyond the end of ");
    }
    append(text, size, range.name);
    if (range.element_bytes == 0) return;
    append(text, size, address < begin ? ", at element -" : ", at element ");
    append(text, size,
           address < begin ? (begin - address + range.element_bytes - 1) / range.element_bytes
                           : (address - begin) / range.element_bytes);
    append(text, size, " of ");
    append(text, size, range.bytes / range.element_bytes);
}

// Says where an address is in terms of the nearest named memory; leaves the text empty if it is not near any.
void place_of(uintptr_t address, char* text, size_t size) {
    uintptr_t nearest = kNear;
    const Named* best = nullptr;
    for (const Named& range : named) {
        const uintptr_t begin = range.begin;
        if (begin == 0) continue;
        const uintptr_t end = begin + range.bytes;
        const uintptr_t away = address < begin ? begin - address : address < end ? 0 : address - end + 1;
        if (away >= nearest) continue;
        nearest = away;
        best = &range;
    }
    if (best) append_place(text, size, address, *best);
}

// The same for an address that is near none: in terms of the nearest named memory before it, from which a wild index may lead
// there.
void far_place_of(uintptr_t address, char* text, size_t size) {
    const Named* best = nullptr;
    for (const Named& range : named)
        if (range.begin != 0 && range.begin < address && address - range.begin < kFar && (!best || range.begin > best->begin))
            best = &range;
    if (!best) return;
    append(text, size, "far from all memory that was given to it; from the nearest before, ");
    append_place(text, size, address, *best);
}

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
    char text[250] = "";
    place_of(address, text, sizeof text);
    if (text[0]) {
        send_short(kChannelFd, MessageKind::death, text);
    } else if (stack_pointer != 0 && distance < (1u << 20)) {
        send_short(kChannelFd, MessageKind::death, "stack overflow");
    } else if (far_place_of(address, text, sizeof text); text[0]) {
        send_short(kChannelFd, MessageKind::death, text);
    } else {
        // Kernels run on many threads. Another one may be about to say more.
        const timespec moment = {0, 50000000};
        nanosleep(&moment, nullptr);
    }
    // After the return the faulty access repeats, now without a handler.
    std::signal(signal, SIG_DFL);
}

[[noreturn]] void on_terminate() {
    try {
        if (std::current_exception()) std::rethrow_exception(std::current_exception());
    } catch (const std::bad_alloc&) {
        send_short(kChannelFd, MessageKind::no_memory, "");
    } catch (const std::exception& e) {
        send_short(kChannelFd, MessageKind::death, e.what());
    } catch (...) {
    }
    std::abort();
}

// Sent once. The code that asked for memory may survive the refusal; if the worker dies instead, this was the reason.
void on_out_of_memory() {
    static bool said = false;
    if (!said) send_short(kChannelFd, MessageKind::no_memory, "");
    said = true;
    throw std::bad_alloc();
}

// Sets our signal handlers, also again: an OpenCL compiler (LLVM's) replaces them when it is loaded. With its handlers, a
// second thread that crashes at the same moment ends the process before anything is reported.
void take_crash_signals() {
    if (kHasCrashReports) return;
    struct sigaction action{};
    action.sa_sigaction = on_crash;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    for (const int signal : {SIGSEGV, SIGBUS}) sigaction(signal, &action, nullptr);
}

void prepare_last_words() {
    std::set_terminate(on_terminate);
    std::set_new_handler(on_out_of_memory);
    if (kHasCrashReports) return;
    const stack_t stack = {signal_stack, 0, sizeof signal_stack};
    sigaltstack(&stack, nullptr);
    take_crash_signals();
}

void send_log(LogLevel level, const std::string& text) {
    send_message(kChannelFd, {MessageKind::log, static_cast<int32_t>(level), 0, text});
}

void begin_worker(const JobKind& kind, long parent) {
    // The kernel ends the worker when its parent dies, because the result is of no use then. The check after the call covers a
    // parent that died before it.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (parent != 0 && getppid() != parent) _exit(1);
#ifdef SYS_close_range
    syscall(SYS_close_range, kArgumentsFd + 1, ~0u, 0);
#endif
    std::signal(SIGPIPE, SIG_IGN);
    std::setvbuf(stdout, nullptr, _IOLBF, 0);  // what a plugin prints reaches the parent at once, and before a crash
    // The parent logs every line. On stderr it would come a second time, as something that a plugin printed.
    set_log_level(static_cast<LogLevel>(static_cast<int>(LogLevel::error) + 1));
    set_log_listener(send_log);
    prepare_last_words();
    send_message(kChannelFd, {MessageKind::greeting, 0, 0, greeting_of(kind.name)});
}

}  // namespace

const JobKind* kind_of_worker(int argc, char** argv, const std::vector<const JobKind*>& kinds) {
    for (const JobKind* kind : kinds)
        if (argc > 1 && std::string(kind->name) + kCommandEnd == argv[1]) return kind;
    return nullptr;
}

// clarity KIND-worker PARENT [SUBJECT]
int worker_main(const JobKind& kind, int argc, char** argv) {
    for (const int fd : {kChannelFd, kResultFd, kArgumentsFd}) {
        if (fcntl(fd, F_GETFD) >= 0) continue;
        std::fprintf(stderr, "workers are started by clarity itself; %s\n", kind.instead);
        return static_cast<int>(Exit::usage);
    }
    begin_worker(kind, argc > 2 ? std::strtol(argv[2], nullptr, 10) : 0);
    Message last{MessageKind::done, 0, 0, {}};
    try {
        const MemoryFile file = MemoryFile::of(kArgumentsFd);
        ParcelReader arguments(file, ParcelReader::How::mapped);
        kind.main(arguments);
    } catch (const Cancelled&) {
        last.kind = MessageKind::cancelled;
    } catch (const std::exception& e) {
        const auto* const error = dynamic_cast<const Error*>(&e);
        last.kind = MessageKind::failed;
        last.level = static_cast<int32_t>(error ? error->failure() : Failure::other);
        last.text = e.what();
    }
    std::fflush(nullptr);  // what libraries printed comes before the end
    send_message(kChannelFd, last);
    // Without destructors: the kernel frees memory faster, a library or a driver may crash in them, and a launch may still run.
    _exit(last.kind == MessageKind::done ? 0 : 1);
}

void ChannelProgress::stage(const std::string& text) {
    send_message(kChannelFd, {MessageKind::stage, 0, 0, text});
}

bool ChannelProgress::report(float fraction) {
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
    send_message(kChannelFd, {MessageKind::progress, 0, fraction, {}});
    return !cancelled();
}

void say_step(const std::string& text, double limit_s) {
    take_crash_signals();
    send_message(kChannelFd, {MessageKind::running, 0, static_cast<float>(limit_s), text});
}

void name_memory(const void* begin, size_t bytes, const std::string& name, size_t element_bytes) {
    const std::lock_guard<std::mutex> lock(named_mutex);
    for (Named& range : named) {
        if (range.begin != 0) continue;
        range.bytes = bytes;
        range.element_bytes = element_bytes;
        std::snprintf(range.name, sizeof range.name, "%s", name.c_str());
        range.begin = reinterpret_cast<uintptr_t>(begin);
        return;
    }
}

void forget_memory(const void* begin) {
    const std::lock_guard<std::mutex> lock(named_mutex);
    for (Named& range : named)
        if (range.begin == reinterpret_cast<uintptr_t>(begin)) range.begin = 0;
}

}  // namespace clarity::worker
