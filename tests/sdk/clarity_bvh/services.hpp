// services.hpp -- the services of a host, for functions of the builders' library that are called without a plugin.
#pragma once
#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "rt_plugin.h"

namespace bvh_test {

class Services {
 public:
    explicit Services(unsigned threads = 2) : threads_(threads) {}
    const rt_host* host() const { return &host_; }
    const std::string& why() const { return why_; }  // of the first failure

 private:
    static int32_t fail(void* ctx, const char* why) {
        auto& own = *static_cast<Services*>(ctx);
        if (own.why_.empty()) own.why_ = why;
        return RT_FAILED;
    }
    static void parallel_for(void* ctx, rt_u32 count, void (*body)(void*, rt_u32), void* user) {
        std::atomic<rt_u32> next{0};
        const auto work = [&] {
            for (rt_u32 i = next++; i < count; i = next++) body(user, i);
        };
        std::vector<std::thread> threads;
        for (unsigned t = 1; t < std::min<unsigned>(static_cast<Services*>(ctx)->threads_, count); ++t)
            threads.emplace_back(work);
        work();
        for (std::thread& thread : threads) thread.join();
    }

    const unsigned threads_;
    std::string why_;
    const rt_host host_{
        sizeof(rt_host), this,    fail, [](void*, int32_t, const char*) {}, [](void*, float) -> int32_t { return 1; },
        parallel_for,    nullptr, 0};
};

}  // namespace bvh_test
