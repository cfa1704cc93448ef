// fresh_memory.hpp -- what memory holds before a program writes to it: zeros as long as it is new, anything later.
#pragma once
#include <cstdint>

namespace clarity::check {

// Fills what malloc() and the stack will give to code that runs next on this thread with copies of one byte, as far as that
// can be reached: blocks that malloc() keeps for reuse, blocks that it makes (until the next call), and 256 KiB of stack.
void fill_fresh_memory(uint8_t byte);
// malloc() fills nothing any more.
void leave_fresh_memory();

}  // namespace clarity::check
