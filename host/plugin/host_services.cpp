#include "plugin/host_services.hpp"

#include <algorithm>
#include <exception>
#include <new>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/parallel_for.hpp"
#include "base/scoped_fp_mode.hpp"
#include "rt_plugin.hpp"

namespace clarity {
namespace {

int32_t host_fail(void* ctx, const char* why) {
    const std::string text = why ? why : "";
    static_cast<HostServices*>(ctx)->fail(text, text == rt::kOutOfMemory ? Failure::no_memory : Failure::other);
    return RT_FAILED;
}

}  // namespace

std::string HostServices::named(const std::string& text) const {
    // "main.scene:3:9: ..." contains the file's name already.
    const bool has_name = plugin_name_.empty() || text.compare(0, plugin_name_.size() + 1, plugin_name_ + ":") == 0;
    if (has_name) return text;
    const bool has_other = !other_name_.empty() && text.compare(0, other_name_.size() + 1, other_name_ + ":") == 0;
    return plugin_name_ + (has_other ? text.substr(other_name_.size()) : ": " + text);
}

void HostServices::set_content(std::string_view bytes) {
    host_.content = reinterpret_cast<const uint8_t*>(bytes.data());
    host_.content_bytes = bytes.size();
}

HostServices::HostServices(std::string name, Progress& progress, std::string other_name)
    : plugin_name_(std::move(name)), other_name_(std::move(other_name)), progress_(progress) {
    host_.struct_bytes = sizeof(rt_host);
    host_.ctx = this;
    host_.fail = host_fail;
    // No exception of the host may pass through a plugin, which may be written in C. If these functions fail, a log line or a
    // progress report is lost.
    host_.log = [](void* ctx, int32_t level, const char* text) {
        try {
            const LogLevel known = level <= RT_LOG_DEBUG  ? LogLevel::debug
                                   : level == RT_LOG_INFO ? LogLevel::info
                                                          : LogLevel::warning;
            log(known, static_cast<HostServices*>(ctx)->named(text ? text : ""));
        } catch (...) {
        }
    };
    host_.progress = [](void* ctx, float fraction) -> int32_t {
        auto* self = static_cast<HostServices*>(ctx);
        bool go_on = false;
        try {
            // The comparison is written so that NaN becomes 0.
            go_on = self->progress_.report(fraction > 0 ? std::min(fraction, 1.0f) : 0.0f);
        } catch (const std::exception& e) {
            self->fail(std::string("the host could not report progress: ") + e.what());
        } catch (...) {
            self->fail("the host could not report progress");
        }
        if (!go_on) self->told_to_stop_ = true;
        return go_on ? 1 : 0;
    };
    // An exception of a body is the plugin's own, so it passes back to the plugin.
    host_.parallel_for = [](void*, uint32_t count, void (*body)(void*, rt_u32), void* user) {
        if (!body) return;
        clarity::parallel_for(count, [body, user](uint32_t i) {
            const ScopedFpMode floats;
            body(user, i);
        });
    };
}

int32_t HostServices::fail(const rt_host* host, const Error& error) {
    static_cast<HostServices*>(host->ctx)->fail(error.what(), error.failure());
    return RT_FAILED;
}

void HostServices::fail(const std::string& why, Failure failure) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (failed_) return;
    failed_ = true;
    failure_ = failure;
    try {
        why_ = why;
    } catch (const std::bad_alloc&) {  // no room for the text: check() then says that no reason is known
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
    const auto error = [&](const std::string& why, Failure failure) {
        return Error(static_cast<Exit>(exit_code), named(why)).as(failure);
    };
    int32_t status = RT_FAILED;
    std::string thrown;
    Failure of_thrown = Failure::plugin_fault;
    try {
        status = call();
    } catch (const Error&) {  // from the host itself, during the call
        throw;
    } catch (const std::bad_alloc&) {
        thrown = rt::kOutOfMemory, of_thrown = Failure::no_memory;
    } catch (const std::exception& e) {
        thrown = std::string("an exception escaped it: ") + e.what();
    } catch (...) {
        thrown = "an exception of unknown type escaped it";
    }
    const bool stopped = told_to_stop_ || progress_.cancelled();
    if (status == RT_CANCELLED && stopped) throw Cancelled();
    if (failed()) {
        const std::string success = status == RT_OK ? " (and then it reported success, a bug of the plugin)" : "";
        if (why().empty()) throw error("failed and gave no reason" + success, Failure::no_reason);
        throw error(why() + success, failure_);
    }
    if (!thrown.empty()) throw error(thrown, of_thrown);
    switch (status) {
        case RT_OK:
            return;
        case RT_FAILED:
            throw error("failed without saying why; the plugin should call host->fail", Failure::no_reason);
        case RT_CANCELLED:
            throw error("returned RT_CANCELLED, but the host had not asked it to stop; a bug of the plugin",
                        Failure::plugin_fault);
        default:
            throw error("returned " + std::to_string(status) + ", which is no status; a bug of the plugin",
                        Failure::plugin_fault);
    }
}

}  // namespace clarity
