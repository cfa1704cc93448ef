// Values that pass through a file in memory arrive whole, or are refused.
#include "base/files/parcel.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "scene/shared_array.hpp"

namespace clarity {
namespace {

struct Part {
    std::string name;
    std::vector<double> numbers;
    CLARITY_MEMBERS(name, numbers);
    bool operator==(const Part& b) const { return name == b.name && numbers == b.numbers; }
};

struct All {
    uint32_t number = 0;
    bool flag = false;
    std::string text;
    std::vector<std::string> texts;
    std::vector<bool> flags;
    std::set<std::string> set;
    std::map<std::string, int> map;
    std::vector<std::pair<std::string, double>> pairs;
    std::vector<Part> parts;
    std::vector<char> bytes;
    SharedArray<uint32_t> large;
    CLARITY_MEMBERS(number, flag, text, texts, flags, set, map, pairs, parts, bytes, large);
};

All sample() {
    All all;
    all.number = 7, all.flag = true, all.text = std::string("a\0b", 3), all.texts = {"", "x", "yy"};
    all.flags = {true, false, true}, all.set = {"p", "q"}, all.map = {{"one", 1}, {"two", 2}}, all.pairs = {{"pi", 3.14}};
    all.parts = {{"first", {1, 2}}, {"", {}}}, all.bytes = {'b', '\0', 'c'};
    std::vector<uint32_t> large(3u << 20);
    for (size_t i = 0; i < large.size(); ++i) large[i] = static_cast<uint32_t>(i * 7);
    all.large = std::move(large);
    return all;
}

void expect_same(const All& a, const All& b) {
    EXPECT_EQ(a.number, b.number);
    EXPECT_EQ(a.flag, b.flag);
    EXPECT_EQ(a.text, b.text);
    EXPECT_EQ(a.texts, b.texts);
    EXPECT_EQ(a.flags, b.flags);
    EXPECT_EQ(a.set, b.set);
    EXPECT_EQ(a.map, b.map);
    EXPECT_EQ(a.pairs, b.pairs);
    EXPECT_EQ(a.parts, b.parts);
    EXPECT_EQ(a.bytes, b.bytes);
    EXPECT_TRUE(a.large == b.large);
}

void write(MemoryFile& file, const All& all) {
    ParcelWriter parcel(file);
    parcel(all);
    parcel.finish();
}

TEST(Parcel, EverythingArrivesHoweverItIsRead) {
    const All sent = sample();
    MemoryFile file;
    write(file, sent);
    file.seal();
    for (const auto how : {ParcelReader::How::copied, ParcelReader::How::mapped}) {
        ParcelReader parcel(file, how);
        All got;
        got.texts = {"is replaced"};
        parcel(got);
        parcel.end();
        expect_same(got, sent);
        EXPECT_EQ(got.large.is_sole_owner(), how == ParcelReader::How::copied);
        EXPECT_EQ(reinterpret_cast<uintptr_t>(got.large.data()) % 4, 0u);
    }
}

TEST(Parcel, WhatIsNotReadIsAFault) {
    MemoryFile file;
    write(file, sample());
    ParcelReader parcel(file, ParcelReader::How::copied);
    uint32_t number = 0;
    parcel(number);
    EXPECT_THROW(parcel.end(), ParcelDamaged);
}

TEST(Parcel, EveryCutAndEverySizeIsChecked) {
    All sent = sample();
    sent.large = {1, 2, 3};
    MemoryFile whole;
    write(whole, sent);
    std::vector<char> all(whole.bytes());
    whole.read_at(0, all.data(), all.size());
    const auto read = [](const std::vector<char>& bytes) {
        MemoryFile file;
        file.write_at(0, bytes.data(), bytes.size());
        file.seal_size();
        ParcelReader parcel(file, ParcelReader::How::copied);
        All got;
        parcel(got);
        parcel.end();
    };
    EXPECT_NO_THROW(read(all));
    for (size_t bytes = 0; bytes < all.size(); ++bytes) {
        const std::vector<char> cut(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(bytes));
        EXPECT_THROW(read(cut), ParcelDamaged) << bytes;
    }
    // Numbers that are as large as can be at every place: nothing of that size is asked for.
    int refused = 0;
    for (size_t at = 0; at + 8 <= all.size(); ++at) {
        std::vector<char> damaged = all;
        std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(at), 8, '\xff');
        try {
            read(damaged);
        } catch (const ParcelDamaged&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 100);
}

TEST(Parcel, AFileWhoseSizeMayChangeIsRefused) {
    MemoryFile file;
    file.write_at(0, "abcd", 4);
    EXPECT_THROW(ParcelReader(file, ParcelReader::How::copied), Error);
    file.seal_size();
    EXPECT_NO_THROW(ParcelReader(file, ParcelReader::How::copied));
    EXPECT_THROW(ParcelReader(file, ParcelReader::How::mapped), Error) << "its content may change";
}

}  // namespace
}  // namespace clarity
