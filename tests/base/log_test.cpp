#include "base/log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "support/errors.hpp"
#include "support/scratch.hpp"

namespace {

namespace fs = std::filesystem;
using clarity::LogLevel;

class Log : public testing::Test {
 protected:
    void TearDown() override {
        clarity::set_log_level(LogLevel::info);
        clarity::set_log_listener({});
        clarity::set_log_file("/dev/null");
    }
    static std::string text_of(const fs::path& path) {
        std::ifstream in(path);
        return std::string(std::istreambuf_iterator<char>(in), {});
    }
    const Scratch scratch_;
    const fs::path folder_ = scratch_.path("");
};

TEST_F(Log, StderrShowsTheLevelAndNoColourOffATerminal) {
    testing::internal::CaptureStderr();
    clarity::log(LogLevel::debug, "hidden");
    clarity::log(LogLevel::info, "plain");
    clarity::log(LogLevel::warning, "careful");
    clarity::log(LogLevel::error, "broken");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "plain\nwarning: careful\nerror: broken\n");
}

TEST_F(Log, QuietAndVerbose) {
    testing::internal::CaptureStderr();
    clarity::set_log_level(LogLevel::warning);
    clarity::log(LogLevel::info, "hidden");
    clarity::log(LogLevel::warning, "shown");
    clarity::set_log_level(LogLevel::debug);
    clarity::log(LogLevel::debug, "detail");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: shown\ndebug: detail\n");
}

TEST_F(Log, TheFileHasEveryLineWithItsTime) {
    const std::string path = (folder_ / "run.log").string();
    clarity::set_log_file(path);
    testing::internal::CaptureStderr();
    clarity::log(LogLevel::debug, "detail");
    clarity::log(LogLevel::error, "broken");
    testing::internal::GetCapturedStderr();
    const std::string text = text_of(path);
    // In the expected shape a digit stands for any digit.
    std::string shape = text;
    for (char& c : shape)
        if (c >= '0' && c <= '9') c = '0';
    EXPECT_EQ(shape, "0000-00-00T00:00:00.000Z debug   detail\n0000-00-00T00:00:00.000Z error   broken\n");
}

TEST_F(Log, AFileThatCannotBeOpenedIsAnError) {
    const std::string path = (folder_ / "missing" / "run.log").string();
    clarity::expect_error([&] { clarity::set_log_file(path); }, {path + ": ", "No such file"});
}

// A full disk causes one warning; rendering goes on.
TEST_F(Log, AFullDiskEndsTheFileWithOneWarning) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    clarity::set_log_file("/dev/full");
    testing::internal::CaptureStderr();
    clarity::log(LogLevel::info, "one");
    clarity::log(LogLevel::info, "two");
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_EQ(text.find("one\nwarning: /dev/full: cannot write the log"), 0u) << text;
    EXPECT_EQ(text.substr(text.size() - 5), "\ntwo\n") << text;
}

TEST_F(Log, TheListenerHearsEveryLevelAndMayLogItself) {
    std::vector<std::string> heard;
    clarity::set_log_listener([&](LogLevel level, const std::string& text) {
        heard.push_back(text);
        if (level == LogLevel::error) clarity::log(LogLevel::debug, "again");
    });
    testing::internal::CaptureStderr();
    clarity::log(LogLevel::debug, "detail");
    clarity::log(LogLevel::error, "broken");
    testing::internal::GetCapturedStderr();
    EXPECT_EQ(heard, (std::vector<std::string>{"detail", "broken", "again"}));
}

TEST_F(Log, LinesOfManyThreadsStayWhole) {
    const std::string path = (folder_ / "threads.log").string();
    clarity::set_log_file(path);
    clarity::set_log_level(LogLevel::error);
    std::vector<std::thread> threads;
    for (int t = 0; t < 8; ++t)
        threads.emplace_back([] {
            for (int i = 0; i < 200; ++i) clarity::log(LogLevel::info, std::string(100, 'x'));
        });
    for (std::thread& thread : threads) thread.join();
    std::ifstream in(path);
    size_t lines = 0;
    for (std::string line; std::getline(in, line); ++lines)
        ASSERT_EQ(line.substr(line.size() - 101), " " + std::string(100, 'x')) << "line " << lines;
    EXPECT_EQ(lines, 1600u);
}

}  // namespace
