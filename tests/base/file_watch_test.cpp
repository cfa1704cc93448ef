// file_watch_test.cpp -- every save is one change, however it is made; a save of the same content is none.
#include "base/files/file_watch.hpp"
#include "support/clock.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <ctime>
#include <mutex>

#include "support/scratch.hpp"

using clarity::FileWatch;
namespace test = clarity::test;
namespace fs = std::filesystem;

namespace {

class Watch : public ::testing::Test {
 protected:
    void SetUp() override {
        a_ = scratch_.write("cl/a.cl", "one");
        b_ = scratch_.write("cl/sub/b.h", "two");
        missing_ = scratch_.path("cl/sub/missing.h");
    }
    void open(FileWatch::Rule rule = FileWatch::Rule::content) {
        const auto changed = [this] {
            const std::lock_guard<std::mutex> lock(mutex_);
            ++calls_;
            called_.notify_all();
        };
        watch_ = std::make_unique<FileWatch>(std::vector<std::string>{a_, b_, missing_}, changed, rule);
    }
    int calls() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return calls_;
    }
    // Waits up to a generous limit: a busy machine must not fail the test, but a change that is never noticed must.
    bool called(int count) {
        std::unique_lock<std::mutex> lock(mutex_);
        return called_.wait_for(lock, std::chrono::duration<double>(test::kHangs_s), [&] { return calls_ >= count; });
    }
    // Changes bytes of the file in one step: where a file is cut and then written, the machine may stop in between, and a look
    // sees an empty file.
    static void overwrite(const std::string& path, const std::string& text) {
        const int file = ::open(path.c_str(), O_WRONLY);
        ASSERT_EQ(pwrite(file, text.data(), text.size(), 0), ssize_t(text.size()));
        close(file);
    }
    // Waits longer than the interval between two looks at the files plus the longest burst.
    static void wait_long() { std::this_thread::sleep_for(std::chrono::milliseconds(1500)); }

    Scratch scratch_;
    std::string a_, b_, missing_;
    std::mutex mutex_;
    std::condition_variable called_;
    int calls_ = 0;
    std::unique_ptr<FileWatch> watch_;
};

TEST_F(Watch, SeesAFileWrittenInPlace) {
    open();
    EXPECT_EQ(watch_->revision(), 0u);
    overwrite(a_, "two");
    ASSERT_TRUE(called(1));
    EXPECT_EQ(watch_->revision(), 1u);
    EXPECT_EQ(watch_->last_changed(), std::vector<std::string>{a_});
}

TEST_F(Watch, SeesAFileRenamedOverIt) {
    open();
    for (int i = 1; i <= 3; ++i) {  // each save replaces the inode
        fs::rename(scratch_.write("cl/.a.cl.swp", "version " + std::to_string(i)), a_);
        ASSERT_TRUE(called(i)) << i;
    }
    EXPECT_EQ(watch_->revision(), 3u);
}

TEST_F(Watch, ABurstIsOneChange) {
    open();
    for (int i = 0; i < 20; ++i) {
        scratch_.write("cl/a.cl", "a" + std::to_string(i));
        scratch_.write("cl/sub/b.h", "b" + std::to_string(i));
    }
    ASSERT_TRUE(called(1));
    wait_long();
    // Each stop of the machine in the middle of the burst divides it.
    EXPECT_LE(watch_->revision(), test::clocks_count() ? 1u : 40u);
    if (watch_->revision() == 1) {
        EXPECT_EQ(watch_->last_changed(), (std::vector<std::string>{a_, b_}));
    }
}

TEST_F(Watch, SeesAFileDeletedAndMadeAgain) {
    open();
    fs::remove(b_);
    ASSERT_TRUE(called(1));
    scratch_.write("cl/sub/b.h", "two");
    ASSERT_TRUE(called(2));
    fs::remove_all(scratch_.path("cl/sub"));
    ASSERT_TRUE(called(3));
    scratch_.write("cl/sub/b.h", "two");
    ASSERT_TRUE(called(4));
    scratch_.write("cl/sub/b.h", "three");  // the folder is watched again after it came back
    ASSERT_TRUE(called(5));
}

TEST_F(Watch, SeesANewFile) {
    open();
    scratch_.write("cl/sub/missing.h", "here");
    ASSERT_TRUE(called(1));
    EXPECT_EQ(watch_->last_changed(), std::vector<std::string>{missing_});
}

TEST_F(Watch, SeesTheTargetOfALink) {
    const std::string target = scratch_.write("elsewhere/real.h", "one");
    fs::create_symlink(target, missing_);
    open();
    scratch_.write("elsewhere/real.h", "two");
    ASSERT_TRUE(called(1));
}

TEST_F(Watch, SameContentAndOtherFilesAreNoChange) {
    open();
    scratch_.write("cl/a.cl", "one");
    fs::rename(scratch_.write("cl/new", "two"), b_);
    fs::last_write_time(a_, fs::file_time_type::clock::now());
    scratch_.write("cl/other.txt", "nobody asked");
    wait_long();
    EXPECT_EQ(calls(), 0);
    EXPECT_EQ(watch_->revision(), 0u);
}

TEST_F(Watch, ByTimesItWaitsUntilAFileIsWritten) {
    open(FileWatch::Rule::times);
    for (int i = 0; i < 70; ++i) {  // three times as long as a burst of small files may be
        scratch_.write("cl/a.cl", std::string(1 + i, 'a'));
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    ASSERT_TRUE(called(1));
    EXPECT_EQ(watch_->last_changed(), std::vector<std::string>{a_});
    wait_long();
    // Each stop of the machine between two writes may be longer than a file rests.
    EXPECT_LE(watch_->revision(), test::clocks_count() ? 1u : 70u);
    EXPECT_EQ(scratch_.read("cl/a.cl").size(), 70u);
}

TEST_F(Watch, ByTimesNothingChangesWhileAFileIsMissing) {
    open(FileWatch::Rule::times);
    fs::remove(b_);
    scratch_.write("cl/a.cl", "refers to b");
    wait_long();
    EXPECT_EQ(watch_->revision(), 0u) << "what is there now cannot be read as a whole";
    fs::rename(scratch_.write("b.h", "two"), b_);  // the same content
    ASSERT_TRUE(called(1));
    EXPECT_EQ(watch_->last_changed(), (std::vector<std::string>{a_, b_}));
}

TEST_F(Watch, EndsAtOnceAndIdlesWithoutCpuTime) {
    open();
    EXPECT_TRUE(watch_->prompt()) << "inotify is not to be had here";
    const std::clock_t before = std::clock();  // processor time of all threads
    wait_long();
    EXPECT_LT(double(std::clock() - before) / CLOCKS_PER_SEC, 0.1);
    scratch_.write("cl/a.cl", "in a burst");
    watch_.reset();  // must not hang, whatever the thread is doing
    FileWatch nothing({}, nullptr);
    EXPECT_EQ(nothing.revision(), 0u);
}

}  // namespace
