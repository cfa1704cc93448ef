#include "check/importers/mutants.hpp"

#include <algorithm>
#include <cstdio>
#include <random>

#include "check/seed.hpp"

namespace clarity::check {
namespace {

using Random = std::mt19937;

size_t below(Random& random, size_t end) {
    return end == 0 ? 0 : random() % end;
}

std::string hex(unsigned char byte) {
    char text[8];
    std::snprintf(text, sizeof text, "0x%02X", byte);
    return text;
}

bool in_number(char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
}

Mutant cut(const std::string& bytes, Random& random) {
    const size_t length = below(random, bytes.size());
    return {"only the first " + std::to_string(length) + " bytes", bytes.substr(0, length)};
}

Mutant change_byte(const std::string& bytes, Random& random) {
    Mutant mutant{{}, bytes};
    const size_t at = below(random, bytes.size());
    constexpr unsigned char kBytes[] = {0x00, 0xFF, 0x7F, 0x80, '{', '}', '"', '\n', '9', '/'};
    const auto before = static_cast<unsigned char>(bytes[at]);
    const unsigned char after =
        random() % 2 ? kBytes[below(random, std::size(kBytes))] : static_cast<unsigned char>(before ^ (1u << random() % 8));
    mutant.bytes[at] = static_cast<char>(after);
    mutant.what = "byte " + std::to_string(at) + " is " + hex(after) + " instead of " + hex(before);
    return mutant;
}

// Counts and offsets of binary files are words.
Mutant change_word(const std::string& bytes, Random& random) {
    Mutant mutant{{}, bytes};
    const size_t at = below(random, bytes.size() / 4) * 4;
    constexpr const char* kWords[] = {"\xFF\xFF\xFF\xFF", "\xFF\xFF\xFF\x7F", "\x00\x00\x00\x80", "\x00\x00\x00\x10",
                                      "\x00\x00\xC0\x7F"};
    constexpr const char* kNames[] = {"0xFFFFFFFF", "0x7FFFFFFF", "0x80000000", "0x10000000", "NaN"};
    const size_t which = below(random, std::size(kWords));
    for (size_t i = 0; i < 4 && at + i < bytes.size(); ++i) mutant.bytes[at + i] = kWords[which][i];
    mutant.what = "the word at byte " + std::to_string(at) + " is " + kNames[which];
    return mutant;
}

Mutant change_block(const std::string& bytes, Random& random) {
    Mutant mutant{{}, bytes};
    const size_t at = below(random, bytes.size()), size = 1 + below(random, std::min<size_t>(bytes.size() - at, 300));
    const std::string place = std::to_string(size) + " bytes from byte " + std::to_string(at) + " are ";
    switch (random() % 3) {
        case 0:
            mutant.bytes.erase(at, size);
            mutant.what = place + "left out";
            break;
        case 1: {
            std::string many;
            for (int i = 0; i < 50; ++i) many += bytes.substr(at, size);
            mutant.bytes.insert(at, many);
            mutant.what = place + "there 51 times";
            break;
        }
        default:
            std::fill_n(mutant.bytes.begin() + static_cast<std::ptrdiff_t>(at), size, '\0');
            mutant.what = place + "zero";
    }
    return mutant;
}

constexpr const char* kNumbers[] = {"4294967295",           "-1", "1e999",      "nan",   "inf",
                                    "99999999999999999999", "0",  "2147483648", "1e-60", ""};

// Replaces the number of a text that stands at or after a place. `place` becomes the end of the new one, or that of the file if
// there is none.
Mutant change_number(const std::string& bytes, size_t& place, const char* number) {
    size_t begin = place;
    while (begin < bytes.size() && !(bytes[begin] >= '0' && bytes[begin] <= '9')) ++begin;
    while (begin > place && in_number(bytes[begin - 1])) --begin;
    size_t end = begin;
    while (end < bytes.size() && in_number(bytes[end])) ++end;
    place = end;
    Mutant mutant{{}, bytes};
    mutant.bytes.replace(begin, end - begin, number);
    mutant.what = "'" + bytes.substr(begin, std::min<size_t>(end - begin, 40)) + "' at byte " + std::to_string(begin) +
                  " is '" + number + "'";
    return mutant;
}

Mutant change_any_number(const std::string& bytes, Random& random) {
    size_t place = below(random, bytes.size());
    Mutant mutant = change_number(bytes, place, kNumbers[below(random, std::size(kNumbers))]);
    return mutant.bytes == bytes ? change_byte(bytes, random) : mutant;
}

}  // namespace

std::vector<Mutant> mutants_of(const std::string& bytes, unsigned count, uint64_t seed) {
    std::vector<Mutant> mutants;
    if (bytes.empty()) return mutants;
    Random random = random_of(static_cast<unsigned>(bytes.size()), seed);
    constexpr Mutant (*kWays[])(const std::string&, Random&) = {cut, change_byte, change_word, change_block, change_any_number};
    // Counts stand at the head of a file: its first numbers get every impossible value.
    for (const char* number : kNumbers)
        for (size_t n = 0, place = 0; n < 3 && place < std::min<size_t>(bytes.size(), 4096); ++n)
            mutants.push_back(change_number(bytes, place, number));
    for (unsigned i = 0; i < count; ++i) mutants.push_back(kWays[i % std::size(kWays)](bytes, random));
    return mutants;
}

std::vector<Mutant> junk() {
    constexpr size_t kMany = 1u << 18;
    Random random(1);
    std::string noise(kMany, '\0');
    for (char& c : noise) c = static_cast<char>(random());
    return {{"one space", " "},
            {"one byte 0xFF", "\xFF"},
            {"zeros", std::string(kMany, '\0')},
            {"random bytes", noise},
            {"brackets that are never closed", std::string(kMany, '{') + std::string(kMany, '(') + std::string(kMany, '[')},
            {"one line of digits without end", std::string(kMany, '7')},
            {"empty lines only", std::string(kMany, '\n')},
            {"quotation marks only", std::string(kMany, '"')}};
}

}  // namespace clarity::check
