// mutants.hpp -- damaged copies of a file, and files that are none. Made by formula: the same on every machine.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace clarity::check {

struct Mutant {
    std::string what;  // "byte 17 is 0xFF instead of 0x03"
    std::string bytes;
};

// `count` copies of a file, each damaged in one way: cut short, bytes replaced, a block left out, doubled or zeroed, a number
// of a text replaced by an impossible one. Before them come copies whose first numbers are impossible. seed: see seed.hpp.
std::vector<Mutant> mutants_of(const std::string& bytes, unsigned count, uint64_t seed);

// Content that no format has: one byte, zeros, random bytes, brackets without end, one endless line.
std::vector<Mutant> junk();

}  // namespace clarity::check
