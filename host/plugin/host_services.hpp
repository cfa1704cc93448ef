// host_services.hpp -- what the host offers a plugin during one call (rt_host): errors, log, progress, threads.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

#include "base/progress.hpp"
#include "rt_plugin.h"

namespace clarity {

// Lives for one call of a plugin.
class HostServices {
 public:
    // who: "accel bvh2", for log lines.
    HostServices(std::string who, Progress& progress);
    HostServices(const HostServices&) = delete;
    HostServices& operator=(const HostServices&) = delete;

    const rt_host* host() const { return &host_; }
    // Records the first reason only; thread-safe.
    void fail(const std::string& why);
    bool failed() const;
    std::string why() const;

    // Runs a call of the plugin, and turns its status, an exception that escaped it, or a call that reports success after
    // fail() into an Error with the given exit code: "<who>: <why>". Cancelled if the plugin returned RT_CANCELLED after it was
    // told so.
    void check(int exit_code, const std::function<int32_t()>& call);

 private:
    std::string who_;
    Progress& progress_;
    rt_host host_{};
    mutable std::mutex mutex_;
    std::string why_;
    bool failed_ = false;
    std::atomic<bool> told_to_stop_{false};  // progress answered 0
};

}  // namespace clarity
