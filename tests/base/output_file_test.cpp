// Files appear complete or not at all, also if the writer is killed in the middle.
#include "base/files/output_file.hpp"
#include "base/host_name.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <vector>

#include "base/error.hpp"
#include "support/scratch.hpp"

namespace {

namespace fs = std::filesystem;

std::vector<std::string> names_in(const Scratch& scratch) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(scratch.path(""))) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

// Runs `work` in a child process, which then kills itself.
template <class Work>
void killed_after(const Work& work) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        work();
        raise(SIGKILL);
        _exit(1);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
}

}  // namespace

TEST(OutputFile, CommitReplacesTheFileAndKeepsItsRights) {
    const Scratch scratch;
    const std::string path = scratch.path("a.txt");
    {
        clarity::OutputFile file(path);
        file.write("one", 3);
        EXPECT_FALSE(fs::exists(path));
        file.commit();
    }
    EXPECT_EQ(scratch.read("a.txt"), "one");
    ASSERT_EQ(chmod(path.c_str(), 0640), 0);
    clarity::write_text_file(path, "two");
    EXPECT_EQ(scratch.read("a.txt"), "two");
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777u, 0640u);
    EXPECT_EQ(names_in(scratch), std::vector<std::string>{"a.txt"});
}

TEST(OutputFile, ANewFileHasTheRightsOfTheUmask) {
    const Scratch scratch;
    const mode_t before = umask(027);
    clarity::write_text_file(scratch.path("a.txt"), "");
    umask(before);
    struct stat status {};
    ASSERT_EQ(stat(scratch.path("a.txt").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777u, 0640u);
}

TEST(OutputFile, WithoutCommitNothingIsLeftAndTheOldFileStays) {
    const Scratch scratch;
    scratch.write("a.txt", "old");
    {
        clarity::OutputFile file(scratch.path("a.txt"));
        file.write("new", 3);
    }
    EXPECT_EQ(scratch.read("a.txt"), "old");
    EXPECT_EQ(names_in(scratch), std::vector<std::string>{"a.txt"});
}

TEST(OutputFile, ALinkStaysALink) {
    const Scratch scratch;
    scratch.write("real.txt", "old");
    fs::create_symlink("real.txt", scratch.path("link.txt"));
    clarity::write_text_file(scratch.path("link.txt"), "new");
    EXPECT_TRUE(fs::is_symlink(scratch.path("link.txt")));
    EXPECT_EQ(scratch.read("real.txt"), "new");
}

// After the kill there is no leftover, or at the latest none after the next write into the folder.
TEST(OutputFile, AKilledWriteLeavesNothingOnceTheFolderIsWrittenAgain) {
    const Scratch scratch;
    killed_after([&] {
        clarity::OutputFile file(scratch.path("a.txt"));
        file.write("half", 4);
        file.write(" of it", 6);
        raise(SIGKILL);
    });
    EXPECT_FALSE(fs::exists(scratch.path("a.txt")));
    clarity::write_text_file(scratch.path("b.txt"), "b");
    EXPECT_EQ(names_in(scratch), std::vector<std::string>{"b.txt"});
}

// In a folder that several machines share, a lock may be seen on one of them only: files of other hosts stay.
TEST(OutputFile, LeftoversAreRemovedButNotFilesThatAreBeingWritten) {
    const Scratch scratch;
    const std::string ours = ".clarity-" + clarity::host_name() + "-", theirs = ".clarity-" + clarity::host_name() + "-7-";
    scratch.write(ours + "999999999-1700000000-0.tmp", "left by a process that is gone");
    scratch.write(theirs + "999999999-1700000000-0.tmp", "being written on another machine, whose name begins like ours");
    const std::string living = scratch.write(ours + "999999999-1700000000-1.tmp", "being written by another process");
    scratch.write(".clarity-notes", "not ours");
    const int file = open(living.c_str(), O_WRONLY | O_CLOEXEC);
    ASSERT_EQ(flock(file, LOCK_EX | LOCK_NB), 0);
    clarity::write_text_file(scratch.path("a.txt"), "a");
    std::vector<std::string> left = {theirs + "999999999-1700000000-0.tmp", ours + "999999999-1700000000-1.tmp",
                                     ".clarity-notes", "a.txt"};
    std::sort(left.begin(), left.end());
    EXPECT_EQ(names_in(scratch), left);
    close(file);
}

TEST(OutputFile, ADeviceFileIsWrittenDirectly) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    clarity::write_text_file("/dev/null", "gone");
    EXPECT_THROW(clarity::write_text_file("/dev/full", "no room"), clarity::Error);
}

TEST(OutputFile, UnwritablePathsAreRefusedBeforeAnyWork) {
    const Scratch scratch;
    const auto why = [](const std::string& path) {
        try {
            clarity::check_writable(path);
        } catch (const clarity::Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_EQ(why(scratch.path("a.txt")), "");
    EXPECT_NE(why(scratch.path("missing/a.txt")).find("its folder does not exist"), std::string::npos);
    EXPECT_NE(why(scratch.path("")).find("it is a folder"), std::string::npos);
    EXPECT_NE(why(scratch.path(std::string(300, 'x'))).find("too long"), std::string::npos);
    EXPECT_TRUE(names_in(scratch).empty());
}
