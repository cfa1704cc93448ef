// store_test.cpp -- programs on disk: found again, never damaged, never too many, and what two processes say to each other.
#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <thread>

#include "compile/compile_job.hpp"
#include "compile/program_store.hpp"
#include "support/scratch.hpp"

namespace {

using namespace clarity;
namespace fs = std::filesystem;

class ProgramStore : public ::testing::Test {
 protected:
    ProgramStore() { setenv("CLARITY_PROGRAM_CACHE", folder().c_str(), 1); }
    ~ProgramStore() override { unsetenv("CLARITY_PROGRAM_CACHE"); }
    std::string folder() const { return scratch_.path("programs"); }
    std::string file(const std::string& key) const { return folder() + "/" + key + ".program"; }
    static std::vector<char> binary(size_t bytes, char value) { return std::vector<char>(bytes, value); }
    size_t files() const { return size_t(std::distance(fs::directory_iterator(folder()), fs::directory_iterator())); }
    Scratch scratch_;
};

TEST_F(ProgramStore, FindsWhatItKept) {
    EXPECT_FALSE(find_program("a"));
    keep_program("a", binary(1000, 'x'));
    keep_program("b", {});
    EXPECT_EQ(find_program("a").value(), binary(1000, 'x'));
    EXPECT_TRUE(find_program("b").value().empty()) << "a program without a binary is known";
    forget_program("a");
    EXPECT_FALSE(find_program("a"));
}

TEST_F(ProgramStore, RefusesEveryDamage) {
    keep_program("a", binary(64, 'x'));
    std::ifstream in(file("a"), std::ios::binary);
    const std::string sound(std::istreambuf_iterator<char>(in), {});
    for (size_t at = 0; at < sound.size(); ++at) {
        std::string damaged = sound;
        damaged[at] ^= 1;
        scratch_.write("programs/a.program", damaged);
        EXPECT_FALSE(find_program("a")) << "byte " << at;
        EXPECT_FALSE(fs::exists(file("a"))) << "a damaged file stays";
    }
    for (const size_t bytes : {size_t(0), size_t(5), sound.size() - 1}) {
        scratch_.write("programs/a.program", sound.substr(0, bytes));
        EXPECT_FALSE(find_program("a")) << "cut to " << bytes;
    }
    scratch_.write("programs/b.program", sound);
    EXPECT_FALSE(find_program("b")) << "the binary of another program";
}

TEST_F(ProgramStore, ForgetsWhatWasUsedLeastRecently) {
    for (const char* key : {"a", "b", "c"}) keep_program(key, binary(5000, 'x'), 17500);
    const auto now = fs::file_time_type::clock::now();
    fs::last_write_time(file("a"), now - std::chrono::hours(1));
    fs::last_write_time(file("b"), now - std::chrono::hours(2));
    EXPECT_TRUE(find_program("b")) << "and is used now";
    keep_program("d", binary(5000, 'x'), 17500);
    EXPECT_FALSE(find_program("a"));
    EXPECT_TRUE(find_program("b"));
    EXPECT_TRUE(find_program("d"));
}

TEST_F(ProgramStore, DoesNotKnowWhatAProcessDiedOf) {
    keep_program("a", {});
    set_aside("a");
    EXPECT_FALSE(find_program("a"));
    put_back("a");
    EXPECT_TRUE(find_program("a"));
    put_back("a");
    EXPECT_TRUE(find_program("a")) << "nothing was aside";
}

TEST_F(ProgramStore, MayBeOffOrUnwritable) {
    setenv("CLARITY_PROGRAM_CACHE", "off", 1);
    keep_program("a", binary(10, 'x'));
    EXPECT_FALSE(find_program("a"));
    scratch_.write("file", "");
    setenv("CLARITY_PROGRAM_CACHE", scratch_.path("file").c_str(), 1);
    keep_program("a", binary(10, 'x'));
    EXPECT_FALSE(find_program("a"));
}

TEST_F(ProgramStore, ServesManyAtOnce) {
    std::vector<std::thread> threads;
    for (char value = 'a'; value < 'e'; ++value)
        threads.emplace_back([value] {
            for (int i = 0; i < 50; ++i) {
                keep_program("one", binary(20000, value));
                if (const auto found = find_program("one")) {
                    EXPECT_EQ(*found, binary(20000, found->front()));
                }
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_TRUE(find_program("one"));
    EXPECT_EQ(files(), 1u) << "temporary files are left";
}

TEST(ProgramKey, NamesAllThatABinaryDependsOn) {
    DeviceInfo info;
    info.platform = "P", info.name = "D", info.driver = "1";
    const std::string key = program_key(info, "source", "options");
    EXPECT_EQ(key.size(), 32u);
    EXPECT_EQ(program_key(info, "source", "options"), key);
    EXPECT_NE(program_key(info, "source2", "options"), key);
    EXPECT_NE(program_key(info, "source", "option"), key);
    EXPECT_NE(program_key(info, "ssource", "option"), key) << "texts must not run into each other";
    DeviceInfo part = info;
    part.parts = 2, part.part = 1, part.name = "D, part 2 of 2";
    EXPECT_EQ(program_key(part, "source", "options"), key) << "parts of a device run the programs of the whole one";
    info.driver = "2";
    EXPECT_NE(program_key(info, "source", "options"), key);
}

template <class Value>
std::vector<char> packed(const Value& value) {
    MemoryFile file;
    ParcelWriter parcel(file);
    parcel(value);
    parcel.finish();
    std::vector<char> bytes(file.bytes());
    file.read_at(0, bytes.data(), bytes.size());
    return bytes;
}
template <class Value>
Value unpacked(const char* bytes, size_t count) {
    MemoryFile file;
    file.write_at(0, bytes, count);
    file.seal_size();
    ParcelReader parcel(file, ParcelReader::How::emptied);
    Value value;
    parcel(value);
    parcel.end();
    return value;
}

TEST(CompileJob, ArrivesWholeOrNotAtAll) {
    const std::vector<char> job = packed(CompileJob{"source", "options", "0:0", "name", "driver", "folder", "method"});
    const CompileJob read = unpacked<CompileJob>(job.data(), job.size());
    EXPECT_EQ(read.source, "source");
    EXPECT_EQ(read.driver, "driver");
    EXPECT_EQ(read.pocl_cache, "folder");
    EXPECT_EQ(read.work_group_method, "method");
    const CompileOutcome outcome{CompileOutcome::failed, -11, "log", {'b', '\0', 'c'}};
    const std::vector<char> sent = packed(outcome);
    const CompileOutcome back = unpacked<CompileOutcome>(sent.data(), sent.size());
    EXPECT_EQ(back.error, -11);
    EXPECT_EQ(back.log, "log");
    EXPECT_EQ(back.binary, outcome.binary);
    for (size_t bytes = 0; bytes < sent.size(); ++bytes)
        EXPECT_THROW(unpacked<CompileOutcome>(sent.data(), bytes), ParcelDamaged) << bytes;
}

}  // namespace
