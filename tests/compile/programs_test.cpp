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
    bool differ = true;  // false: in a comment alone, so that PoCL takes them for one program
};

class UsedProgram {
 public:
    UsedProgram(Device& device, unsigned number, bool differs) : device_(device), number_(differs ? number : 0) {
        Progress progress;
        const std::string name = "program " + std::to_string(number);
        // The array is cleared by a call of memset() through the library's table of addresses, which is lost with its pages.
        const std::string text = "/* " + name +
                                 " */ kernel void answer(global int *out, const global int *zeros) {"
                                 "  int all[512] = {0};"
                                 "  const int i = get_global_id(0);"
                                 "  all[zeros[i]] = i;"
                                 "  out[i] = " +
                                 std::to_string(number_) + " + all[zeros[i]] + all[511 - zeros[i]]; }";
        program_ = compile_program(device, {text, "-cl-std=CL1.2", name}, progress).program;
    }
    bool answers() {
        cl::Buffer out(device_.context(), CL_MEM_READ_WRITE, kItems * sizeof(cl_int));
        cl_int read[kItems] = {};
        cl::Buffer zeros(device_.context(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof read, read);
        cl::Kernel kernel(program_, "answer");
        kernel.setArg(0, out);
        kernel.setArg(1, zeros);
        device_.queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(kItems), cl::NDRange(kItems));
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
            UsedProgram program(device, work.first + i, work.differ);
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

TEST_F(Programs, StayAsTheyAreWhenThreeAreOneToTheDriver) {
    const Work work{0, 3, 2, kStoreBytes, false};
    expect_right(work, "all are compiled");
    EXPECT_EQ(kept(), work.programs);
    expect_right(work, "all are loaded from the store");
    expect_nothing_left();
}

TEST_F(Programs, AreSharedByThreadsAndProcesses) {
    const Work work{0, 2, 2, kStoreBytes};
    const auto both_at_once = [&] {
        int wrong[2] = {1, 1};
        std::thread one([&] { wrong[0] = wrong_answers(work); }), other([&] { wrong[1] = wrong_answers(work); });
        one.join();
        other.join();
        return wrong[0] + wrong[1];
    };
    for (const char* start_is : {"cold", "warm"}) {
        const pid_t one = start(both_at_once), other = start(both_at_once);
        EXPECT_EQ(end_of(one), 0) << start_is;
        EXPECT_EQ(end_of(other), 0) << start_is;
    }
    EXPECT_EQ(kept(), work.programs);
    expect_nothing_left();
}

// In two processes whose store holds two programs. They have half of the programs in common. CLARITY_TEST_PROGRAMS: so many in
// each; with 200 they are more than the 128 libraries that PoCL keeps open.
TEST_F(Programs, AreAsManyAsThereAre) {
    const char* wanted = std::getenv("CLARITY_TEST_PROGRAMS");
    const unsigned programs = wanted ? unsigned(std::atoi(wanted)) : 24;
    const Work one{0, programs, 2, kRoomForTwo}, other{programs / 2, programs, 2, kRoomForTwo};
    const pid_t first = start([&] { return wrong_answers(one); }), second = start([&] { return wrong_answers(other); });
    EXPECT_EQ(end_of(first), 0);
    EXPECT_EQ(end_of(second), 0);
    EXPECT_LE(kept(), 4u) << "two, and what each process keeps last";
    expect_nothing_left();
}

}  // namespace
