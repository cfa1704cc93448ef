// host_services.hpp -- the services of the host during one call of a plugin (rt_host): errors, log, progress, threads.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "rt_plugin.h"

namespace clarity {

// Exists for one call of a plugin.
class HostServices {
 public:
    // name: what log lines and error messages begin with, "accel bvh2"; empty: nothing, where the reader of them knows.
    // other_name: what the plugin calls it where that differs: the name of a packed file's content.
    HostServices(std::string name, Progress& progress, std::string other_name = {});
    HostServices(const HostServices&) = delete;
    HostServices& operator=(const HostServices&) = delete;

    const rt_host* host() const { return &host_; }
    // The bytes of the file that an importer is to load, where it cannot read them itself. They must outlive the call.
    void set_content(std::string_view bytes);
    // Records why the call failed. Only the first reason is kept. Thread-safe.
    void fail(const std::string& why, Failure failure = Failure::other);
    // The same for the services behind `host`. Returns RT_FAILED.
    static int32_t fail(const rt_host* host, const Error& error);
    bool failed() const;
    std::string why() const;

    // Calls the plugin. Throws Error(exit_code) "<name>: <why>" if the call returns a failure, throws an exception, or returns
    // success after fail(). Throws Cancelled if the plugin returns RT_CANCELLED after progress told it to stop.
    void check(int exit_code, const std::function<int32_t()>& call);

 private:
    // "<name>: <text>", or the text alone if it begins with the name.
    std::string named(const std::string& text) const;

    std::string plugin_name_, other_name_;
    Progress& progress_;
    rt_host host_{};
    mutable std::mutex mutex_;
    std::string why_;
    Failure failure_ = Failure::other;
    bool failed_ = false;
    std::atomic<bool> told_to_stop_{false};  // progress has returned 0
};

}  // namespace clarity
