// Files appear complete or not at all, also if the writer is killed in the middle.
#include "base/files/output_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files/memory_file.hpp"
#include "base/files/process_folder.hpp"
#include "base/files/read_file.hpp"
#include "base/machine.hpp"
#include "support/clock.hpp"
#include "support/errors.hpp"
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
    struct stat status{};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777u, 0640u);
    EXPECT_EQ(names_in(scratch), std::vector<std::string>{"a.txt"});
}

TEST(OutputFile, ANewFileHasTheRightsOfTheUmask) {
    const Scratch scratch;
    const mode_t before = umask(027);
    clarity::write_text_file(scratch.path("a.txt"), "");
    umask(before);
    struct stat status{};
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

// // Whole files are read up to a limit. Pipes and devices, which may have no end, are refused.

namespace {

std::string why_not(const std::string& path, uint64_t limit = 100) {
    std::string content;
    return clarity::try_read_file(path, limit, content).text();
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST(ReadFile, ReadsAllBytesUpToTheLimit) {
    const Scratch scratch;
    for (const size_t size : {0, 1, 99, 100}) {
        const std::string path = scratch.write("a", std::string(size, '\0'));
        EXPECT_EQ(clarity::read_file(path, 100, clarity::Exit::failed), std::string(size, '\0'));
    }
    const std::string large(200000, 'x');
    EXPECT_EQ(clarity::read_file(scratch.write("b", large), 1 << 20, clarity::Exit::failed), large);
    EXPECT_TRUE(contains(why_not(scratch.write("c", std::string(101, 'x'))), "larger than 100 bytes"));
    EXPECT_TRUE(contains(why_not(scratch.write("d", std::string((1 << 20) + 1, 'x')), 1 << 20), "larger than 1 MiB"));
}

TEST(ReadFile, ReadsFilesOfProcThatClaimZeroBytes) {
    EXPECT_FALSE(clarity::read_file("/proc/self/status", 1 << 20, clarity::Exit::failed).empty());
    EXPECT_TRUE(contains(why_not("/proc/self/status", 10), "larger than 10 bytes"));
}

TEST(ReadFile, RefusesOtherThanRegularFilesAtOnce) {
    const Scratch scratch;
    ASSERT_EQ(mkfifo(scratch.path("pipe").c_str(), 0600), 0);
    EXPECT_TRUE(contains(why_not(scratch.path("")), "is a folder"));
    EXPECT_TRUE(contains(why_not(scratch.path("pipe")), "no regular file"));
    EXPECT_TRUE(contains(why_not("/dev/zero"), "no regular file"));
    EXPECT_TRUE(contains(why_not(scratch.path("missing")), "No such file"));
    const std::string why =
        clarity::expect_error([] { clarity::read_file("/dev/zero", 100, clarity::Exit::usage); }, {}, clarity::Exit::usage);
    EXPECT_EQ(why.find("/dev/zero: is no regular file"), 0u) << why;
}

// // Files in memory which processes of a host share.

namespace clarity {
namespace {

TEST(MemoryFile, AnotherProcessReadsItThroughItsAddress) {
    MemoryFile file;
    const std::string text(100000, 'x');
    file.write_at(5, text.data(), text.size());
    EXPECT_EQ(file.bytes(), text.size() + 5);
    file.seal();
    const MemoryFile::Address address = file.address();
    const pid_t child = fork();
    if (child == 0) {
        const std::optional<MemoryFile> opened = MemoryFile::open(address);
        if (!opened || !opened->sealed() || opened->bytes() != text.size() + 5) _exit(1);
        const std::shared_ptr<const char> bytes = map_file(opened->fd(), opened->bytes());
        _exit(std::memcmp(bytes.get() + 5, text.data(), text.size()) == 0 ? 0 : 2);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
}

TEST(MemoryFile, NoOtherFileIsTakenForIt) {
    const MemoryFile file, other;
    MemoryFile::Address address = file.address();
    address.descriptor = other.fd();
    EXPECT_FALSE(MemoryFile::open(address)) << "another file of the same process";
    address = file.address();
    address.process = 1 << 30;
    EXPECT_FALSE(MemoryFile::open(address)) << "no such process";
}

TEST(MemoryFile, NobodyChangesItOnceItIsSealed) {
    MemoryFile file;
    file.write_at(0, "abc", 3);
    EXPECT_FALSE(file.sealed());
    void* const writable = mmap(nullptr, 3, PROT_READ | PROT_WRITE, MAP_SHARED, file.fd(), 0);
    ASSERT_NE(writable, MAP_FAILED);
    EXPECT_THROW(file.seal(), Error) << "the mapping could still change it";
    munmap(writable, 3);
    file.seal();
    EXPECT_TRUE(file.sealed());
    EXPECT_THROW(file.write_at(0, "x", 1), Error);
    EXPECT_NE(ftruncate(file.fd(), 0), 0);
    char first = 0;
    file.read_at(0, &first, 1);
    EXPECT_EQ(first, 'a');
    EXPECT_THROW(file.read_at(2, &first, 2), Error) << "it is shorter than that";
}

TEST(MemoryFile, AMappingOutlivesTheFile) {
    std::shared_ptr<const char> bytes;
    {
        MemoryFile file;
        file.write_at(0, "abc", 3);
        file.seal();
        bytes = map_file(file.fd(), 3);
    }
    EXPECT_EQ(std::string(bytes.get(), 3), "abc");
    EXPECT_THROW(map_file(MemoryFile().fd(), 0), Error);
}

// // Folders that nothing of a process outlives.

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
    EXPECT_TRUE(clarity::test::comes([&] { return count() == 0; }));
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
