// Folders that nothing of a process outlives.
#include "base/files/process_folder.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <vector>

#include "support/scratch.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

class ProcessFolders : public ::testing::Test {
 protected:
    fs::path parent() const { return scratch_.path("parent"); }
    size_t count() const {
        std::error_code none;
        return size_t(std::distance(fs::directory_iterator(parent(), none), fs::directory_iterator()));
    }
    // Makes a folder in another process and runs `end` there. Returns the status of that process when it is gone.
    template <class End>
    int in_child(End&& end) {
        const pid_t child = fork();
        if (child == 0) {
            const auto folder = ProcessFolder::make(parent(), "one");
            std::ofstream(folder->path() / "file") << "x";
            end();
            _exit(0);
        }
        int status = 0;
        waitpid(child, &status, 0);
        return status;
    }
    Scratch scratch_;
};

TEST_F(ProcessFolders, IsGoneAtTheEndWithItsParent) {
    fs::path path;
    {
        const auto folder = ProcessFolder::make(parent(), "one");
        const auto other = ProcessFolder::make(parent(), "one");
        ASSERT_TRUE(folder && other);
        EXPECT_NE(folder->path(), other->path());
        path = folder->path();
        fs::create_directories(path / "a/b");
        std::ofstream(path / "a/b/file") << "x";
        EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    }
    EXPECT_FALSE(fs::exists(path));
    EXPECT_FALSE(fs::exists(parent()));
}

TEST_F(ProcessFolders, TheNextOneRemovesWhatAKilledProcessLeft) {
    in_child([] { raise(SIGKILL); });
    EXPECT_EQ(count(), 1u) << "nothing could remove it";
    const auto folder = ProcessFolder::make(parent(), "one");
    EXPECT_EQ(count(), 1u) << "its own";
    const auto other = ProcessFolder::make(parent(), "one");
    EXPECT_TRUE(fs::exists(folder->path())) << "of a process that lives";
}

TEST_F(ProcessFolders, OneThatIsInTheMakingStays) {
    fs::create_directories(parent() / "one-ABCDEF");
    fs::permissions(parent() / "one-ABCDEF", fs::perms::owner_all);  // whatever the umask
    const auto folder = ProcessFolder::make(parent(), "one");
    EXPECT_TRUE(fs::exists(parent() / "one-ABCDEF"));
    fs::last_write_time(parent() / "one-ABCDEF", fs::file_time_type::clock::now() - std::chrono::hours(1));
    const auto other = ProcessFolder::make(parent(), "one");
    EXPECT_FALSE(fs::exists(parent() / "one-ABCDEF")) << "not for ever";
}

// A driver's threads work on until the process has ended.
TEST_F(ProcessFolders, FoldersThatAreLeftStayUntilTheProcessHasEnded) {
    const int status = in_child([this] {
        leave_process_folders();
        for (int i = 0; i < 30; ++i, usleep(10000))
            if (count() == 0) _exit(1);
    });
    EXPECT_EQ(status, 0) << "it was gone before";
    for (int i = 0; i < 500 && count() > 0; ++i) usleep(10000);
    EXPECT_EQ(count(), 0u);
}

// Each looks for what others left, and removes the parent when it is empty.
TEST_F(ProcessFolders, ProcessesThatStartAndEndTogetherKeepTheirs) {
    constexpr int kProcesses = 4, kRounds = 300;
    std::vector<pid_t> children;
    for (int i = 0; i < kProcesses; ++i) {
        children.push_back(fork());
        if (children.back() != 0) continue;
        int failed = 0;
        for (int round = 0; round < kRounds; ++round) {
            const auto folder = ProcessFolder::make(parent(), "one");
            failed += !folder || !fs::exists(folder->path() / "lock");
        }
        _exit(failed > 0);
    }
    for (const pid_t child : children) {
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    EXPECT_FALSE(fs::exists(parent()));
}

TEST_F(ProcessFolders, ThereMayBeNoPlace) {
    scratch_.write("file", "");
    EXPECT_FALSE(ProcessFolder::make(scratch_.path("file"), "one"));
}

}  // namespace
}  // namespace clarity
