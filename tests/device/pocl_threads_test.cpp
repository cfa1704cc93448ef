
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <set>

#include "device/device_list.hpp"

using namespace clarity;

namespace {

std::vector<size_t> cores_of(pid_t thread) {
    cpu_set_t set;
    CPU_ZERO(&set);
    EXPECT_EQ(sched_getaffinity(thread, sizeof set, &set), 0);
    std::vector<size_t> cores;
    for (size_t core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &set)) cores.push_back(core);
    return cores;
}

TEST(PoclThreads, HaveACoreOfTheirOwnAmongThoseOfTheProcess) {
    cpu_set_t all, one;
    ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
    CPU_ZERO(&one);
    CPU_SET(cores_of(0).front(), &one);
    const bool pins = sched_setaffinity(0, sizeof one, &one) == 0 && cores_of(0).size() == 1;
    if (sched_setaffinity(0, sizeof all, &all) != 0 || !pins) GTEST_SKIP() << "this system pins no threads";
    const std::vector<pid_t> before = thread_ids();
    const std::vector<DeviceInfo> devices = list_devices(nullptr);
    const auto pocl = std::find_if(devices.begin(), devices.end(), [](const DeviceInfo& d) { return d.pocl && d.cpu; });
    if (pocl == devices.end()) GTEST_SKIP() << "PoCL is not installed";
    const std::vector<size_t> allowed = cores_of(0);
    std::multiset<size_t> used;
    for (const pid_t thread : thread_ids()) {
        if (std::binary_search(before.begin(), before.end(), thread)) continue;
        const std::vector<size_t> cores = cores_of(thread);
        ASSERT_EQ(cores.size(), 1u) << "thread " << thread << " is free";
        EXPECT_TRUE(std::count(allowed.begin(), allowed.end(), cores[0]));
        used.insert(cores[0]);
    }
    ASSERT_EQ(used.size(), pocl->compute_units);
    for (const size_t core : allowed)
        EXPECT_LE(used.count(core), (used.size() + allowed.size() - 1) / allowed.size()) << "core " << core;
    EXPECT_EQ(cores_of(0), allowed) << "the thread that asks for devices stays free";
}

}  // namespace
