#include "check/importers/fresh_memory.hpp"

#include <malloc.h>

#include <cstdlib>
#include <cstring>

namespace clarity::check {
namespace {

[[gnu::noinline]] void fill_stack(uint8_t byte) {
    volatile uint8_t below[256 << 10];
    for (volatile uint8_t& at : below) at = byte;
}

// glibc keeps up to seven freed blocks of each size up to 1032 bytes, and hands them out again without filling them.
void fill_kept_blocks(uint8_t byte) {
    constexpr size_t kLargest = 1032, kStep = 16, kOfEach = 16;
    for (size_t bytes = 24; bytes <= kLargest; bytes += kStep) {
        void* blocks[kOfEach];
        for (void*& block : blocks) {
            block = std::malloc(bytes);
            if (!block) continue;
            std::memset(block, byte, bytes);
            asm volatile("" : : "r"(block) : "memory");  // or the compiler would leave the filling out
        }
        for (void* block : blocks) std::free(block);
    }
}

}  // namespace

void fill_fresh_memory(uint8_t byte) {
    mallopt(M_PERTURB, byte ^ 0xFF);  // fills new blocks with the complement
    fill_kept_blocks(byte);
    fill_stack(byte);
}

void leave_fresh_memory() {
    mallopt(M_PERTURB, 0);
}

}  // namespace clarity::check
