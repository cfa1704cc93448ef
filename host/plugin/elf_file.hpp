// elf_file.hpp -- reads a shared library's exported data from its file, without loading it.
#pragma once
#include <cstdint>
#include <string>

namespace clarity {

// An exported symbol as the file describes it, and the first bytes of its value.
struct ElfSymbol {
    bool found = false;
    bool is_data = false;   // an object, not a function
    uint64_t bytes = 0;     // size of the whole value
    uint32_t head[4] = {};  // its first 16 bytes; what the value lacks of them is zero
};

// Looks up an exported symbol by the tables that the dynamic loader itself uses. Every offset is checked against the file's
// size, so a hostile or truncated file costs an answer, not a crash. Returns an empty text if the file is a complete shared
// library for the machine that this program runs on, else why it is not and what to do.
std::string read_elf_symbol(const std::string& path, const char* name, ElfSymbol& symbol);

}  // namespace clarity
