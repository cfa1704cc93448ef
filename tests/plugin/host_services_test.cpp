#include "plugin/host_services.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"

namespace {

using clarity::Exit;
using clarity::HostServices;

// Calls a plugin function and returns the Error's text: "" without an error, "cancelled" for Cancelled.
template <class Call>
std::string outcome(clarity::Progress& progress, Call call, Exit code = Exit::failed) {
    HostServices services("accel test", progress);
    try {
        services.check(static_cast<int>(code), [&] { return call(services.host()); });
    } catch (const clarity::Cancelled&) {
        return "cancelled";
    } catch (const clarity::Error& e) {
        EXPECT_EQ(e.code(), code);
        return e.what();
    }
    return "";
}
template <class Call>
std::string outcome(Call call) {
    clarity::Progress progress;
    return outcome(progress, call);
}

TEST(HostServices, SuccessIsSilent) {
    EXPECT_EQ(outcome([](const rt_host* host) {
                  EXPECT_EQ(host->struct_bytes, sizeof(rt_host));
                  EXPECT_EQ(host->progress(host->ctx, 0.5f), 1);
                  return RT_OK;
              }),
              "");
}

TEST(HostServices, TheFirstReasonWins) {
    EXPECT_EQ(outcome([](const rt_host* host) {
                  EXPECT_EQ(host->fail(host->ctx, "vertex 7 is not finite"), RT_FAILED);
                  return host->fail(host->ctx, "so nothing was built");
              }),
              "accel test: vertex 7 is not finite");
}

TEST(HostServices, AFailureWithoutAReasonSaysSo) {
    EXPECT_NE(outcome([](const rt_host*) { return RT_FAILED; }).find("host->fail"), std::string::npos);
    EXPECT_EQ(outcome([](const rt_host* host) { return host->fail(host->ctx, nullptr); }),
              "accel test: failed and gave no reason");
}

TEST(HostServices, SuccessAfterFailIsAFailure) {
    const std::string what = outcome([](const rt_host* host) {
        host->fail(host->ctx, "no memory");
        return RT_OK;
    });
    EXPECT_EQ(what.find("accel test: no memory"), 0u) << what;
    EXPECT_NE(what.find("reported success"), std::string::npos) << what;
}

TEST(HostServices, AnUnknownStatusIsAFailure) {
    EXPECT_NE(outcome([](const rt_host*) { return 77; }).find("returned 77"), std::string::npos);
}

TEST(HostServices, ExceptionsStopHere) {
    EXPECT_EQ(outcome([](const rt_host*) -> int32_t { throw std::runtime_error("lost"); }),
              "accel test: an exception escaped it: lost");
    EXPECT_EQ(outcome([](const rt_host*) -> int32_t { throw std::bad_alloc(); }), "accel test: out of memory");
    EXPECT_NE(outcome([](const rt_host*) -> int32_t { throw 42; }).find("unknown type"), std::string::npos);
    EXPECT_EQ(outcome([](const rt_host* host) -> int32_t {
                  host->fail(host->ctx, "the reason");
                  throw std::runtime_error("what came of it");
              }),
              "accel test: the reason");
}

TEST(HostServices, AnExceptionInALoopComesBackToThePlugin) {
    EXPECT_EQ(outcome([](const rt_host* host) {
                  try {
                      host->parallel_for(
                          host->ctx, 100, [](void*, rt_u32 i) { throw std::runtime_error(std::to_string(i)); }, nullptr);
                  } catch (const std::runtime_error& e) {
                      return host->fail(host->ctx, e.what());
                  }
                  return int32_t{RT_OK};
              }),
              "accel test: 0");
}

TEST(HostServices, CancelledOnlyAfterItWasTold) {
    clarity::Progress progress;
    const auto call = [](const rt_host* host) {
        return host->progress(host->ctx, 0.1f) ? int32_t{RT_OK} : int32_t{RT_CANCELLED};
    };
    EXPECT_EQ(outcome(progress, call), "");
    progress.cancel();
    EXPECT_EQ(outcome(progress, call), "cancelled");
    EXPECT_NE(outcome([](const rt_host*) { return RT_CANCELLED; }).find("had not asked it to stop"), std::string::npos);
}

// A Progress that stands for another process may return false without being cancelled itself.
struct Refusing : clarity::Progress {
    bool report(float) override { return false; }
};
TEST(HostServices, ProgressThatReturnsFalseCancels) {
    Refusing progress;
    EXPECT_EQ(
        outcome(progress,
                [](const rt_host* host) { return host->progress(host->ctx, 0.1f) ? int32_t{RT_OK} : int32_t{RT_CANCELLED}; }),
        "cancelled");
}

struct Recording : clarity::Progress {
    std::vector<float> fractions;
    bool report(float fraction) override {
        fractions.push_back(fraction);
        return true;
    }
};
TEST(HostServices, ProgressIsKeptWithinItsRange) {
    Recording progress;
    outcome(progress, [](const rt_host* host) {
        for (const float f : {-1.0f, 0.25f, 7.0f, std::nanf("")}) host->progress(host->ctx, f);
        return RT_OK;
    });
    EXPECT_EQ(progress.fractions, (std::vector<float>{0, 0.25f, 1, 0}));
}

struct Throwing : clarity::Progress {
    bool report(float) override { throw std::runtime_error("the pipe is closed"); }
};
TEST(HostServices, AFailingProgressIsAFailureAndDoesNotUnwindThroughThePlugin) {
    Throwing progress;
    const std::string what = outcome(progress, [](const rt_host* host) {
        EXPECT_EQ(host->progress(host->ctx, 0), 0);
        return RT_FAILED;
    });
    EXPECT_NE(what.find("the pipe is closed"), std::string::npos) << what;
}

TEST(HostServices, LogNamesThePlugin) {
    std::vector<std::pair<clarity::LogLevel, std::string>> lines;
    clarity::set_log_listener([&](clarity::LogLevel level, const std::string& text) { lines.emplace_back(level, text); });
    outcome([](const rt_host* host) {
        host->log(host->ctx, RT_LOG_DEBUG, "one");
        host->log(host->ctx, RT_LOG_WARNING, nullptr);
        return RT_OK;
    });
    clarity::set_log_listener({});
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0], (std::pair<clarity::LogLevel, std::string>(clarity::LogLevel::debug, "accel test: one")));
    EXPECT_EQ(lines[1].first, clarity::LogLevel::warning);
}

TEST(HostServices, FailFromManyThreadsKeepsOne) {
    const std::string what = outcome([](const rt_host* host) {
        host->parallel_for(
            host->ctx, 1000,
            [](void* user, rt_u32) { static_cast<const rt_host*>(user)->fail(static_cast<const rt_host*>(user)->ctx, "one"); },
            const_cast<rt_host*>(host));
        return RT_FAILED;
    });
    EXPECT_EQ(what, "accel test: one");
}

}  // namespace
