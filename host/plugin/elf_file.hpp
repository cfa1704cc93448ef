// elf_file.hpp -- reads exported data of a shared library from its file, without loading the library.
#pragma once
#include <cstdint>
#include <string>
#include "base/problem.hpp"

namespace clarity {

// An exported symbol, as the file describes it.
struct ElfSymbol {
    bool found = false;
    bool is_data = false;   // true for an object, false for a function
    uint64_t bytes = 0;     // size of the whole value in bytes
    uint32_t head[4] = {};  // first 16 bytes of the value; zeros beyond its end
};

// Looks up an exported symbol through the tables that the dynamic loader uses. Every offset is checked against the file's size,
// so a hostile or truncated file gives an error text, not a crash. Returns nothing if the file is a complete shared
// library for this machine (`symbol.found` tells whether it exports the name), otherwise what is wrong and what to do.
Problem read_elf_symbol(const std::string& path, const char* name, ElfSymbol& symbol);

}  // namespace clarity
