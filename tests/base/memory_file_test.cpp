// Files in memory which processes of a host share.
#include "base/files/memory_file.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <string>

#include "base/error.hpp"

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

}  // namespace
}  // namespace clarity
