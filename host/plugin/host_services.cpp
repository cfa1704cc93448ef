#include "plugin/host_services.hpp"

#include <algorithm>
#include <exception>
#include <new>

#include "base/default_floats.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "plugin/thread_loop.hpp"
#ifdef CLARITY_HAVE_TBB
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace clarity {
namespace {

// The exception of the lowest index, so that a failing loop reports the same one on every run.
class FirstException {
 public:
    // False: a body before this one failed, its result can no longer matter.
    bool wanted(uint32_t i) const { return i < index_.load(std::memory_order_relaxed); }
    void keep(uint32_t i) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (i >= index_) return;
        index_ = i;
        exception_ = std::current_exception();
    }
    void rethrow() const {
        if (exception_) std::rethrow_exception(exception_);
    }

 private:
    std::mutex mutex_;
    std::atomic<uint64_t> index_{uint64_t{1} << 32};
    std::exception_ptr exception_;
};

template <class Body>
void run_on_all_cores(uint32_t count, const Body& body) {
#ifdef CLARITY_HAVE_TBB
    // Isolated: a thread that waits for this loop takes no iteration of an outer one. A body may hold a lock or a
    // thread-local scratch across its inner loop.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(uint32_t{0}, count, body); });
#else
    thread_loop(count, body);
#endif
}

int32_t host_fail(void* ctx, const char* why) {
    static_cast<HostServices*>(ctx)->fail(why ? why : "");
    return RT_FAILED;
}

}  // namespace

void parallel_for(uint32_t count, const std::function<void(uint32_t)>& body) {
    if (count == 0) return;
    if (count == 1) return body(0);
    FirstException first;
    run_on_all_cores(count, [&](uint32_t i) {
        if (!first.wanted(i)) return;
        try {
            body(i);
        } catch (...) {
            first.keep(i);
        }
    });
    first.rethrow();
}

HostServices::HostServices(std::string who, Progress& progress) : who_(std::move(who)), progress_(progress) {
    host_.struct_bytes = sizeof(rt_host);
    host_.ctx = this;
    host_.fail = host_fail;
    // No exception of ours may unwind through a plugin, which may be C: a log line or a report can be lost, a call cannot
    // throw.
    host_.log = [](void* ctx, int32_t level, const char* text) {
        try {
            const LogLevel known = level <= RT_LOG_DEBUG  ? LogLevel::debug
                                   : level == RT_LOG_INFO ? LogLevel::info
                                                          : LogLevel::warning;
            const std::string& who = static_cast<HostServices*>(ctx)->who_;
            const std::string said = text ? text : "";
            // "main.scene:3:9: ..." names its file already.
            log(known, said.compare(0, who.size() + 1, who + ":") == 0 ? said : who + ": " + said);
        } catch (...) {
        }
    };
    host_.progress = [](void* ctx, float fraction) -> int32_t {
        auto* self = static_cast<HostServices*>(ctx);
        bool go_on = false;
        try {
            // Written so that NaN becomes 0.
            go_on = self->progress_.report(fraction > 0 ? std::min(fraction, 1.0f) : 0.0f);
        } catch (const std::exception& e) {
            self->fail(std::string("the host could not report progress: ") + e.what());
        } catch (...) {
            self->fail("the host could not report progress");
        }
        if (!go_on) self->told_to_stop_ = true;
        return go_on ? 1 : 0;
    };
    // What a body throws is the plugin's own and goes back to it.
    host_.parallel_for = [](void*, uint32_t count, void (*body)(void*, rt_u32), void* user) {
        if (!body) return;
        clarity::parallel_for(count, [body, user](uint32_t i) {
            const DefaultFloats floats;
            body(user, i);
        });
    };
}

void HostServices::fail(const std::string& why) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (failed_) return;
    failed_ = true;
    try {
        why_ = why;
    } catch (const std::bad_alloc&) {  // then check() says that no reason is known
    }
}

bool HostServices::failed() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return failed_;
}

std::string HostServices::why() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return why_;
}

void HostServices::check(int exit_code, const std::function<int32_t()>& call) {
    const auto error = [&](const std::string& why) { return Error(static_cast<Exit>(exit_code), who_ + ": " + why); };
    int32_t status = RT_FAILED;
    std::string thrown;
    try {
        status = call();
    } catch (const Error&) {  // the host's own, from inside the call
        throw;
    } catch (const std::bad_alloc&) {
        thrown = "out of memory";
    } catch (const std::exception& e) {
        thrown = std::string("an exception escaped it: ") + e.what();
    } catch (...) {
        thrown = "an exception of unknown type escaped it";
    }
    const bool stopped = told_to_stop_ || progress_.cancelled();
    if (status == RT_CANCELLED && stopped) throw Cancelled();
    if (failed()) {
        const std::string reason = why().empty() ? "failed and gave no reason" : why();
        throw error(reason + (status == RT_OK ? " (and then it reported success, a bug of the plugin)" : ""));
    }
    if (!thrown.empty()) throw error(thrown);
    switch (status) {
        case RT_OK:
            return;
        case RT_FAILED:
            throw error("failed without saying why; the plugin should call host->fail");
        case RT_CANCELLED:
            throw error("said it was cancelled, but nobody had cancelled it; a bug of the plugin");
        default:
            throw error("returned " + std::to_string(status) + ", which is no status; a bug of the plugin");
    }
}

}  // namespace clarity
