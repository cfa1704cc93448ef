// programs_test.cpp -- any number of programs in one process, which come back, also while other threads and processes compile
// and load the same: none is written to while it is in use. Kernels are tiny, so that a worker takes most of the time.
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "compile/compile.hpp"
#include "compile/program_store.hpp"
#include "device/device.hpp"
#include "support/scratch.hpp"

namespace {

using namespace clarity;
namespace fs = std::filesystem;

constexpr size_t kItems = 64;
constexpr uint64_t kRoomForTwo = 300 << 10;  // of the programs here, which take 100 to 150 KiB
constexpr int kNoDevice = 77;

// What one process does. The exit code is the number of wrong answers.
struct Work {
    unsigned first = 0, programs = 18, turns = 2;
    uint64_t store_bytes = kStoreBytes;
};

class UsedProgram {
 public:
    UsedProgram(Device& device, unsigned number) : device_(device), number_(number) {
        Progress progress;
        const std::string text = "kernel void answer(global int *out) { out[get_global_id(0)] = " + std::to_string(number) +
                                 " + (int)get_global_id(0); }";
        program_ = compile_program(device, {text, "-cl-std=CL1.2", "program " + std::to_string(number)}, progress).program;
    }
    bool answers() {
        cl::Buffer out(device_.context(), CL_MEM_READ_WRITE, kItems * sizeof(cl_int));
        cl::Kernel kernel(program_, "answer");
        kernel.setArg(0, out);
        device_.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(kItems), cl::NDRange(kItems));
        cl_int read[kItems] = {};
        device_.queue().enqueueReadBuffer(out, true, 0, sizeof read, read);
        for (size_t i = 0; i < kItems; ++i)
            if (read[i] != cl_int(number_ + i)) return false;
        return true;
    }

 private:
    Device& device_;
    const unsigned number_;
    cl::Program program_;
};

// Every other program stays, and answers again at the end of each turn.
int wrong_answers(const Work& work) {
    Device device(choose_device(""));
    std::vector<UsedProgram> held;
    int wrong = 0;
    for (unsigned turn = 0; turn < work.turns; ++turn) {
        for (unsigned i = 0; i < work.programs; ++i) {
            UsedProgram program(device, work.first + i);
            wrong += !program.answers();
            if (turn == 0 && i % 2) held.push_back(program);
            if (work.store_bytes != kStoreBytes) keep_program("another", {}, work.store_bytes);
        }
        for (UsedProgram& program : held) wrong += !program.answers();
    }
    return wrong;
}

// Starts a process. The parent never loads a driver.
pid_t start(const std::function<int()>& work) {
    const pid_t child = fork();
    if (child != 0) return child;
    int code = 1;
    try {
        code = work();
    } catch (const Error& e) {
        code = e.code() == Exit::no_device ? kNoDevice : 1;
        std::fprintf(stderr, "%s\n", e.what());
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
    }
    std::exit(code);
}

// The exit code, or 128 + signal.
int end_of(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

class Programs : public ::testing::Test {
 protected:
    void SetUp() override {
        environment_.set("CLARITY_COMPILE", "worker");
        environment_.set("CLARITY_PROGRAM_CACHE", scratch_.path("programs"));
        environment_.set("POCL_CACHE_DIR", scratch_.path("pocl"));
        if (end_of(start([] { return choose_device("").name.empty(); })) == kNoDevice)
            GTEST_SKIP() << "no OpenCL device on this machine";
    }
    static void expect_right(const Work& work, const char* what) {
        EXPECT_EQ(end_of(start([&] { return wrong_answers(work); })), 0) << what << ": wrong answers, or 128 + signal";
    }
    size_t kept() const {
        return size_t(std::distance(fs::directory_iterator(scratch_.path("programs")), fs::directory_iterator()));
    }
    // That PoCL's folders of the processes are gone.
    void expect_nothing_left() const {
        EXPECT_FALSE(fs::exists(scratch_.path("pocl")) && !fs::is_empty(scratch_.path("pocl")));
    }
    Scratch scratch_;
    Environment environment_;
};

TEST_F(Programs, StayAsTheyAreWhenTheyComeBack) {
    expect_right({}, "all are compiled");
    EXPECT_EQ(kept(), Work().programs);
    expect_right({}, "all are loaded from the store");
    EXPECT_EQ(kept(), Work().programs);
    expect_nothing_left();
}

TEST_F(Programs, AreSharedByThreadsAndProcesses) {
    const Work work{0, 5, 2, kStoreBytes};
    const auto all_at_once = [&] {
        std::vector<int> wrong(4, 1);
        std::vector<std::thread> threads;
        for (int& one : wrong) threads.emplace_back([&] { one = wrong_answers(work); });
        for (std::thread& thread : threads) thread.join();
        return wrong[0] + wrong[1] + wrong[2] + wrong[3];
    };
    for (const char* start_is : {"cold", "warm"}) {
        const pid_t one = start(all_at_once), other = start(all_at_once);
        EXPECT_EQ(end_of(one), 0) << start_is;
        EXPECT_EQ(end_of(other), 0) << start_is;
    }
    EXPECT_EQ(kept(), work.programs);
    expect_nothing_left();
}

// More than the 128 libraries that PoCL keeps open, in two processes whose store holds two programs. They have half of the
// programs in common.
TEST_F(Programs, AreAsManyAsThereAre) {
    const Work one{0, 200, 2, kRoomForTwo}, other{100, 200, 2, kRoomForTwo};
    const pid_t first = start([&] { return wrong_answers(one); }), second = start([&] { return wrong_answers(other); });
    EXPECT_EQ(end_of(first), 0);
    EXPECT_EQ(end_of(second), 0);
    EXPECT_LE(kept(), 4u) << "two, and what each process keeps last";
    expect_nothing_left();
}

}  // namespace
