// Formats: "System V Application Binary Interface", chapters 4 and 5; the GNU hash section as the loader of glibc reads it.
#include "plugin/elf_file.hpp"

#include <elf.h>
#include <fcntl.h>
#include <link.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

namespace clarity {
namespace {

using Header = ElfW(Ehdr);
using Segment = ElfW(Phdr);
using Dynamic = ElfW(Dyn);
using Symbol = ElfW(Sym);

// Hash chains have a handful of symbols and dynamic sections some dozens of entries. The limit ends the walk through hostile
// ones.
constexpr uint32_t kMaxSteps = 4096;
constexpr uint64_t kMaxName = 4096;

// A regular file, read piece by piece. A mapping would need less code, but would raise SIGBUS if a linker rewrote the file
// meanwhile.
class File {
 public:
    explicit File(const std::string& path) {
        fd_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // opening a pipe of that name must not block
        if (fd_ < 0) {
            why_ = std::string("cannot be opened: ") + std::strerror(errno);
            return;
        }
        struct stat status{};
        if (fstat(fd_, &status) != 0)
            why_ = std::string("cannot be examined: ") + std::strerror(errno);
        else if (S_ISDIR(status.st_mode))
            why_ = "is a folder; folders of plugins go into CLARITY_PLUGIN_PATH";
        else if (!S_ISREG(status.st_mode))
            why_ = "is no regular file";
        else
            bytes_ = static_cast<uint64_t>(status.st_size);
    }
    ~File() {
        if (fd_ >= 0) close(fd_);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    const std::string& why() const { return why_; }
    uint64_t bytes() const { return bytes_; }
    // Returns false if a part of the range lies outside of the file.
    bool read(uint64_t offset, void* to, uint64_t count) const {
        if (offset > bytes_ || count > bytes_ - offset) return false;
        auto* out = static_cast<char*>(to);
        while (count > 0) {
            const ssize_t got = pread(fd_, out, count, static_cast<off_t>(offset));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) return false;
            out += got;
            offset += static_cast<uint64_t>(got);
            count -= static_cast<uint64_t>(got);
        }
        return true;
    }
    template <class T>
    bool read(uint64_t offset, T& value) const {
        return read(offset, &value, sizeof value);
    }

 private:
    int fd_ = -1;
    uint64_t bytes_ = 0;
    std::string why_;
};

std::string machine_name(unsigned machine) {
    constexpr std::pair<unsigned, const char*> kNames[] = {
        {EM_386, "x86 (32 bit)"}, {EM_X86_64, "x86-64"},    {EM_ARM, "ARM (32 bit)"}, {EM_AARCH64, "AArch64"},
        {EM_RISCV, "RISC-V"},     {EM_PPC64, "PowerPC 64"}, {EM_S390, "S/390"},       {EM_LOONGARCH, "LoongArch"}};
    for (const auto& [number, name] : kNames)
        if (number == machine) return name;
    return "machine number " + std::to_string(machine);
}

// Reads the ELF header of the running program: this machine can certainly load a library with the same values.
bool read_own_header(Header& header) {
    return File("/proc/self/exe").read(0, header);
}

// Translates addresses: dynamic tables contain addresses, and the loaded segments tell where in the file they are.
class Image {
 public:
    Image(const File& file, std::vector<Segment> segments) : file_(file), segments_(std::move(segments)) {}
    // Reads memory as it would be loaded; the zeroed tail of a segment reads as zeros. Returns false if the address is not
    // mapped from the file.
    bool read(uint64_t address, void* to, uint64_t count) const {
        for (const Segment& segment : segments_) {
            if (segment.p_type != PT_LOAD || address < segment.p_vaddr) continue;
            const uint64_t skip = address - segment.p_vaddr;
            if (skip > segment.p_memsz || count > segment.p_memsz - skip) continue;
            const uint64_t stored = skip < segment.p_filesz ? std::min<uint64_t>(count, segment.p_filesz - skip) : 0;
            std::memset(to, 0, count);
            return stored == 0 || (segment.p_offset <= UINT64_MAX - skip && file_.read(segment.p_offset + skip, to, stored));
        }
        return false;
    }
    template <class T>
    bool read(uint64_t address, T& value) const {
        return read(address, &value, sizeof value);
    }

 private:
    const File& file_;
    std::vector<Segment> segments_;
};

struct DynamicTables {
    uint64_t symbols = 0, strings = 0, string_bytes = 0, gnu_hash = 0, hash = 0;
};

// Finds a symbol as dlsym does: with the GNU hash table, otherwise with the older one.
class SymbolLookup {
 public:
    SymbolLookup(const Image& image, const DynamicTables& tables, const char* name)
        : image_(image), tables_(tables), name_(name) {}

    // Returns 1 if the symbol is found, 0 if it is not there, -1 if the tables are broken.
    int find(Symbol& found) const {
        if (tables_.symbols == 0 || tables_.strings == 0) return 0;
        if (tables_.gnu_hash != 0) return by_gnu_hash(found);
        if (tables_.hash != 0) return by_hash(found);
        return 0;
    }

 private:
    // Addresses are 64-bit sums of numbers from a file that may be hostile. They may wrap around, and are then found to be
    // unmapped.
    int matches(uint32_t index, Symbol& symbol) const {
        if (!image_.read(tables_.symbols + uint64_t{index} * sizeof(Symbol), symbol)) return -1;
        const uint64_t bytes = std::strlen(name_) + 1;
        if (symbol.st_name > tables_.string_bytes || bytes > tables_.string_bytes - symbol.st_name) return 0;
        char text[kMaxName];
        if (bytes > sizeof text || !image_.read(tables_.strings + symbol.st_name, text, bytes)) return -1;
        return std::memcmp(text, name_, bytes) == 0 && symbol.st_shndx != SHN_UNDEF ? 1 : 0;
    }

    int by_gnu_hash(Symbol& found) const {
        uint32_t head[4];  // number of buckets, index of the first hashed symbol, number of bloom words, bloom shift
        if (!image_.read(tables_.gnu_hash, head)) return -1;
        const uint64_t buckets = tables_.gnu_hash + sizeof head + uint64_t{head[2]} * sizeof(ElfW(Addr));
        const uint64_t chains = buckets + uint64_t{head[0]} * 4;
        uint32_t hash = 5381;
        for (const char* c = name_; *c; ++c) hash = hash * 33 + static_cast<unsigned char>(*c);
        uint32_t index = 0;
        if (head[0] == 0) return 0;
        if (!image_.read(buckets + uint64_t{hash % head[0]} * 4, index)) return -1;
        if (index == 0) return 0;
        if (index < head[1]) return -1;
        for (uint32_t step = 0; step < kMaxSteps; ++step, ++index) {
            uint32_t chained = 0;  // the hash; its lowest bit is set in the last symbol of the chain
            if (!image_.read(chains + uint64_t{index - head[1]} * 4, chained)) return -1;
            if ((chained | 1) == (hash | 1))
                if (const int match = matches(index, found)) return match;
            if (chained & 1) return 0;
        }
        return -1;
    }

    int by_hash(Symbol& found) const {
        uint32_t head[2];  // number of buckets, number of chains
        if (!image_.read(tables_.hash, head)) return -1;
        uint32_t hash = 0;
        for (const char* c = name_; *c; ++c) {
            hash = (hash << 4) + static_cast<unsigned char>(*c);
            hash ^= (hash & 0xf0000000u) >> 24;
            hash &= 0x0fffffffu;
        }
        if (head[0] == 0) return 0;
        uint64_t at = tables_.hash + sizeof head + uint64_t{hash % head[0]} * 4;
        for (uint32_t step = 0; step < kMaxSteps; ++step) {
            uint32_t index = 0;
            if (!image_.read(at, index)) return -1;
            if (index == STN_UNDEF) return 0;
            if (const int match = matches(index, found)) return match;
            at = tables_.hash + sizeof head + (uint64_t{head[0]} + index) * 4;
        }
        return -1;
    }

    const Image& image_;
    const DynamicTables& tables_;
    const char* name_;
};

Problem check_header(const File& file, Header& header) {
    const std::string rebuild = "; build the plugin with cmake as docs/plugins.md shows, and name the .so that it makes";
    if (file.bytes() == 0) return "is an empty file, not a shared library" + rebuild;
    unsigned char ident[EI_NIDENT];
    if (!file.read(0, ident) || std::memcmp(ident, ELFMAG, SELFMAG) != 0)
        return "is not a shared library (no ELF header)" + rebuild;
    Header own{};
    if (!read_own_header(own)) return "cannot be compared with this program: /proc/self/exe is not readable; mount /proc";
    const char* for_this_machine = "; rebuild the plugin on, or for, this machine";
    if (ident[EI_CLASS] != own.e_ident[EI_CLASS] || ident[EI_DATA] != own.e_ident[EI_DATA])
        return std::string("is a library for another kind of machine (") + (ident[EI_CLASS] == ELFCLASS32 ? "32" : "64") +
               " bit, " + (ident[EI_DATA] == ELFDATA2MSB ? "big" : "little") +
               " endian; this program: " + (own.e_ident[EI_CLASS] == ELFCLASS32 ? "32" : "64") + " bit, " +
               (own.e_ident[EI_DATA] == ELFDATA2MSB ? "big" : "little") + " endian)" + for_this_machine;
    if (!file.read(0, header)) return "is truncated: its ELF header is not whole; copy or build it again";
    if (header.e_machine != own.e_machine)
        return "is a library for " + machine_name(header.e_machine) + ", this program runs on " + machine_name(own.e_machine) +
               for_this_machine;
    if (header.e_type != ET_DYN)
        return std::string("is an ELF file, but not a shared library (") +
               (header.e_type == ET_REL    ? "an object file"
                : header.e_type == ET_EXEC ? "a program"
                                           : "some other type") +
               ")" + rebuild;
    return {};
}

Problem read_segments(const File& file, const Header& header, std::vector<Segment>& segments) {
    if (header.e_phentsize != sizeof(Segment) || header.e_phnum == 0) return "is a damaged ELF file: it has no program headers";
    segments.resize(header.e_phnum);
    if (!file.read(header.e_phoff, segments.data(), segments.size() * sizeof(Segment)))
        return "is truncated: its program headers lie outside of the file; copy or build it again";
    for (const Segment& segment : segments) {
        if (segment.p_type != PT_LOAD && segment.p_type != PT_DYNAMIC) continue;
        // The loader would map such a segment, and the program would die of SIGBUS on first access.
        if (segment.p_offset > file.bytes() || segment.p_filesz > file.bytes() - segment.p_offset)
            return "is truncated: a segment of " + std::to_string(segment.p_filesz) + " bytes at " +
                   std::to_string(segment.p_offset) + " does not fit into its " + std::to_string(file.bytes()) +
                   " bytes; copy or build it again";
    }
    return {};
}

Problem read_dynamic(const File& file, const std::vector<Segment>& segments, DynamicTables& tables) {
    for (const Segment& segment : segments) {
        if (segment.p_type != PT_DYNAMIC) continue;
        for (uint64_t at = 0; at + sizeof(Dynamic) <= segment.p_filesz && at / sizeof(Dynamic) < kMaxSteps;
             at += sizeof(Dynamic)) {
            Dynamic entry{};
            if (!file.read(segment.p_offset + at, entry)) return "is a damaged ELF file: its dynamic section cannot be read";
            switch (entry.d_tag) {
                case DT_NULL:
                    return {};
                case DT_SYMTAB:
                    tables.symbols = entry.d_un.d_ptr;
                    break;
                case DT_STRTAB:
                    tables.strings = entry.d_un.d_ptr;
                    break;
                case DT_STRSZ:
                    tables.string_bytes = entry.d_un.d_val;
                    break;
                case DT_GNU_HASH:
                    tables.gnu_hash = entry.d_un.d_ptr;
                    break;
                case DT_HASH:
                    tables.hash = entry.d_un.d_ptr;
                    break;
                default:
                    break;
            }
        }
        return {};
    }
    return "is an ELF file without a dynamic section (a statically linked program?); build it as a shared library";
}

}  // namespace

Problem read_elf_symbol(const std::string& path, const char* name, ElfSymbol& symbol) {
    symbol = {};
    const File file(path);
    if (!file.why().empty()) return file.why();
    Header header{};
    std::vector<Segment> segments;
    DynamicTables tables;
    if (Problem why = check_header(file, header)) return why;
    if (Problem why = read_segments(file, header, segments)) return why;
    if (Problem why = read_dynamic(file, segments, tables)) return why;
    const Image image(file, std::move(segments));
    Symbol found{};
    const int result = SymbolLookup(image, tables, name).find(found);
    if (result < 0) return "is a damaged ELF file: its symbol tables point outside of it; copy or build it again";
    if (result == 0) return {};
    symbol.found = true;
    symbol.is_data = (found.st_info & 0xf) == STT_OBJECT;
    symbol.bytes = found.st_size;
    const uint64_t head_bytes = std::min<uint64_t>(sizeof symbol.head, found.st_size);
    if (!image.read(found.st_value, symbol.head, head_bytes))
        return std::string("is a damaged ELF file: its symbol ") + name + " points outside of it; copy or build it again";
    return {};
}

}  // namespace clarity
