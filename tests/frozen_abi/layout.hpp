// layout.hpp -- sizes and offsets of the ABI's structs, as one header has them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

struct FieldLayout {
    std::string name;
    size_t offset, bytes;
};
struct StructLayout {
    std::string name;
    size_t bytes;
    bool grows;
    std::vector<FieldLayout> fields;  // those of version 2, in order
};

struct AbiLayout {
    uint32_t version, digest, contract;
    std::vector<StructLayout> structs;
};

AbiLayout layout_then();  // of the frozen header
AbiLayout layout_now();   // of today's header
