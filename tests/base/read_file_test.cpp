// Whole files are read up to a limit. Pipes and devices, which may have no end, are refused.
#include "base/files/read_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "support/errors.hpp"
#include "support/scratch.hpp"

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
