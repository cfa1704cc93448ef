#include "api/library.hpp"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "base/files/library_files.hpp"
#include "base/log.hpp"
#include "plugin/trust.hpp"

namespace clarity::api {
namespace {

namespace fs = std::filesystem;

// Of the process in which the library was used first; 0: not yet.
std::atomic<pid_t> first_process{0};

// Calls and frees that are under way.
std::atomic<int64_t> under_way{0};
std::atomic<bool> ended{false};
thread_local bool has_ended_it = false, in_callers_function = false;

// Counts one of them. No thread is between this count and the question whether the library has ended, so clarity_end() sees
// each that goes on.
class UnderWay {
 public:
    UnderWay() { ++under_way; }
    ~UnderWay() { --under_way; }
    UnderWay(const UnderWay&) = delete;
    UnderWay& operator=(const UnderWay&) = delete;
};

struct Failure {
    std::string text, details;
};
Failure& failure() {
    static thread_local Failure last;
    return last;
}

// Never destroyed, because threads that outlive the process's end may still ask.
struct State {
    std::mutex mutex;
    std::string program;  // that the caller has named
    std::unique_ptr<const PluginRegistry> plugins;
};
State& state() {
    static State* const only = new State;
    return *only;
}

bool may_run(const fs::path& file) {
    std::error_code error;
    return fs::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0;
}

fs::path find_program(const std::string& named) {
    if (!named.empty()) return fs::absolute(named);
    std::error_code error;
    const fs::path library = fs::canonical(loaded_file_of(reinterpret_cast<const void*>(&find_program)), error);
    const fs::path folder = library.parent_path();
    for (const char* there : {"clarity", "../bin/clarity", "../../bin/clarity"})
        if (!error && may_run(folder / there)) return (folder / there).lexically_normal();
    if (const char* worker = std::getenv("CLARITY_WORKER"); worker && *worker) return fs::absolute(worker);
    throw Error(Exit::failed, library.string() +
                                  ": the program `clarity`, which does what may crash, is not beside this library: " +
                                  "call clarity_set_program(), or set CLARITY_WORKER to its path");
}

// Returns false in a process that was forked from one that had used the library.
bool begin_use() {
    pid_t none = 0;
    const pid_t self = getpid();
    return first_process.compare_exchange_strong(none, self) || none == self;
}

bool is_forked() {
    const pid_t first = first_process;
    return first != 0 && first != getpid();
}

bool is_refused() {
    return ended && !has_ended_it;
}

// A library prints nothing: its first call keeps the log off stderr.
void keep_quiet() {
    [[maybe_unused]] static const bool once = (set_log_to_stderr(false), true);
}

int32_t failed(int32_t code, const std::string& text, const std::string& details = {}) noexcept {
    try {
        failure() = {text, details};
    } catch (...) {  // without memory there is no text
    }
    return code;
}

int32_t run(bool is_light, const std::function<void()>& call) noexcept {
    const UnderWay counted;
    const auto refused_at_end = [] {
        return failed(CLARITY_ENDED, "the process ends: another thread has called clarity_end()");
    };
    try {
        failure() = {};
        if (in_callers_function)
            return failed(CLARITY_USAGE,
                          "the library was called by a function that it calls itself, for progress, rows or the log, and "
                          "waits for: note there what is to be done, and do it after the call");
        if (is_refused()) return refused_at_end();
        keep_quiet();
        if (is_light ? is_forked() : !begin_use())
            return failed(CLARITY_FORKED,
                          "this process was forked from one that had used the library, and OpenCL drivers do not "
                          "survive that: start another program instead, or fork before the first call");
        call();
        if (!failure().text.empty()) failure() = {};  // of a refused call of the caller's function
        return CLARITY_OK;
    } catch (const Cancelled& e) {
        return is_refused() ? refused_at_end() : failed(CLARITY_CANCELLED, e.what());
    } catch (const Error& e) {
        return failed(static_cast<int32_t>(e.code()), e.what(), e.details());
    } catch (const std::bad_alloc&) {
        return failed(CLARITY_FAILED, "out of memory: take a smaller scene or picture, or fewer rays");
    } catch (const std::exception& e) {
        return failed(CLARITY_FAILED, std::string("unexpected failure: ") + e.what());
    } catch (...) {
        return failed(CLARITY_FAILED, "unexpected failure");
    }
}

}  // namespace

int32_t run_call(const std::function<void()>& call) noexcept {
    return run(false, call);
}
int32_t run_light_call(const std::function<void()>& call) noexcept {
    return run(true, call);
}

void run_free(const std::function<void()>& free) {
    const UnderWay counted;
    if (!is_forked() && !is_refused()) free();
}

bool has_ended() {
    return ended;
}
bool goes_on_after_end() {
    return has_ended_it;
}

void end_library() {
    constexpr int kMost_ms = 10000;
    has_ended_it = true;
    ended = true;
    // This call is one of them.
    for (int ms = 0; under_way > 1 && ms < kMost_ms; ++ms) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

InCallersFunction::InCallersFunction() : outer_(std::exchange(in_callers_function, true)) {}
InCallersFunction::~InCallersFunction() {
    in_callers_function = outer_;
}

const std::string& error_text() {
    return failure().text;
}
const std::string& error_details() {
    return failure().details;
}

const PluginRegistry& plugins() {
    State& s = state();
    const std::lock_guard<std::mutex> lock(s.mutex);
    if (!s.plugins) {
        set_program_file(find_program(s.program));
        trust_own_libraries_only();  // the process is not ours to lose
        s.plugins = std::make_unique<const PluginRegistry>(PluginRegistry::discover());
    }
    return *s.plugins;
}

void set_program(const std::string& path) {
    if (!may_run(path)) throw Error(Exit::usage, path + ": is no program that can be started; name the program `clarity`");
    State& s = state();
    const std::lock_guard<std::mutex> lock(s.mutex);
    if (s.plugins) throw Error(Exit::usage, "clarity_set_program(): the library is in use already; call it first");
    s.program = path;
}

void set_log(void (*log)(void*, int32_t, const char*), void* user) {
    if (!log) return set_log_listener({});
    set_log_listener([log, user](LogLevel level, const std::string& text) {
        const InCallersFunction calling;
        log(user, static_cast<int32_t>(level), text.c_str());
    });
}

}  // namespace clarity::api
