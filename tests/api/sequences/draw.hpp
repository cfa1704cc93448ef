// draw.hpp -- random numbers of one step: they depend on the seed and the step alone, so that any steps can be repeated without
// those before them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>

namespace sequences {

// SplitMix64 (Steele, Lea, Flood 2014, Fast Splittable Pseudorandom Number Generators).
class Draw {
 public:
    Draw(uint64_t seed, uint64_t step) : state_(mixed(seed) ^ mixed(~step)) {}
    uint64_t bits() { return mixed(state_ += 0x9e3779b97f4a7c15); }
    size_t below(size_t count) { return static_cast<size_t>(bits() % count); }
    double real(double lo = 0, double hi = 1) { return lo + (hi - lo) * (static_cast<double>(bits() >> 11) * 0x1p-53); }
    bool chance(double p) { return real() < p; }
    template <class T>
    T one_of(std::initializer_list<T> values) {
        return *(values.begin() + below(values.size()));
    }

 private:
    static uint64_t mixed(uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    }
    uint64_t state_;
};

}  // namespace sequences
