// Layout: a Header, then sections at multiples of 64 bytes. Each section is the array of one member of Scene, in the order of
// `visit`. Elements with a name are split: their plain data, with the length of the name, is in a section of their kind; all
// names, one after the other, are in the last section.
#include "import/wire.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <type_traits>

#include "import/scene_sections.hpp"

namespace clarity::import {
namespace {

constexpr uint64_t kMagic = 0x31656E6563536C43;  // "ClScene1"
constexpr uint64_t kPieceAlignment = 64;
constexpr const char* kUnreadable = "the shared memory cannot be read";
// Writing is not sealed, because the reader gives pages back behind its reading, which counts as writing. The reader copies
// each byte once and checks the copy, so that what is written later does nothing.
constexpr int kSeals = F_SEAL_SHRINK | F_SEAL_GROW;

struct Section {
    uint64_t offset, bytes;
};
struct Header {
    uint64_t magic, total_bytes;
    Section sections[kSectionCount];
};
// Bytes that both processes hold at the same time while an array goes from one to the other.
constexpr uint64_t kBytesAtOnce = uint64_t(4) << 20;
// Bytes that are copied out of the file at once: they stay in the processor's cache until they are in their array.
constexpr uint64_t kCopiedAtOnce = uint64_t(256) << 10;

// The whole pages within a range of addresses or offsets.
template <class Body>
void for_whole_pages(uint64_t first, uint64_t end, const Body& body) {
    static const uint64_t page = static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
    first = (first + page - 1) / page * page;
    end = end / page * page;
    if (first < end) body(first, end - first);
}

// Appends all bytes to the file. write() may stop early. Returns an empty text on success, otherwise the reason.
std::string append(int fd, const char* from, uint64_t bytes) {
    while (bytes > 0) {
        const ssize_t written = write(fd, from, bytes);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return std::string("cannot write the scene into shared memory: ") + std::strerror(errno);
        from += written;
        bytes -= static_cast<uint64_t>(written);
    }
    return {};
}

// Appends an array to the file, and gives its memory back to the system behind the writing: afterwards its elements are lost.
template <class T>
std::string move_to_file(int fd, std::vector<T>& array) {
    std::string why;
    auto* const bytes = reinterpret_cast<char*>(array.data());
    const uint64_t size = array.size() * sizeof(T);
    for (uint64_t at = 0; at < size && why.empty(); at += kBytesAtOnce) {
        const uint64_t piece = std::min(kBytesAtOnce, size - at);
        why = append(fd, bytes + at, piece);
        const uint64_t address = reinterpret_cast<uintptr_t>(bytes) + at;
        for_whole_pages(address, address + piece, [](uint64_t first, uint64_t length) {
            madvise(reinterpret_cast<void*>(first), length, MADV_DONTNEED);
        });
    }
    std::vector<T>().swap(array);
    return why;
}

// Elements that others have, too, are copied.
template <class T>
std::string move_to_file(int fd, SharedArray<T>& array) {
    std::string why = array.is_sole_owner() ? move_to_file(fd, array.own())
                                            : append(fd, reinterpret_cast<const char*>(array.data()), array.size() * sizeof(T));
    array.clear();
    return why;
}

// Reserves memory and asks for large pages where it spans some, because half of the reading time is spent on page faults.
template <class T>
void reserve_on_large_pages(std::vector<T>& array, size_t count) {
    constexpr uintptr_t kLargePage = 2u << 20;
    array.reserve(count);
    const uintptr_t first = (reinterpret_cast<uintptr_t>(array.data()) + kLargePage - 1) / kLargePage * kLargePage;
    const uintptr_t last = reinterpret_cast<uintptr_t>(array.data() + count) / kLargePage * kLargePage;
    if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
}

// Copies bytes out of the file. Returns false if they are not all there.
bool copy_from_file(int fd, uint64_t offset, void* to, uint64_t bytes) {
    auto* at = static_cast<char*>(to);
    while (bytes > 0) {
        const ssize_t count = pread(fd, at, bytes, static_cast<off_t>(offset));
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        at += count;
        offset += static_cast<uint64_t>(count);
        bytes -= static_cast<uint64_t>(count);
    }
    return true;
}

// Copies a section of the file into an array, and gives the file's memory back to the system behind the reading.
template <class T>
bool move_from_file(int fd, const Section& section, std::vector<char>& buffer, std::vector<T>& array) {
    reserve_on_large_pages(array, section.bytes / sizeof(T));
    buffer.resize(std::max<uint64_t>(1, kCopiedAtOnce / sizeof(T)) * sizeof(T));
    uint64_t given_back = section.offset;
    for (uint64_t done = 0; done < section.bytes;) {
        const uint64_t piece = std::min<uint64_t>(buffer.size(), section.bytes - done);
        if (!copy_from_file(fd, section.offset + done, buffer.data(), piece)) return false;
        const auto* first = reinterpret_cast<const T*>(buffer.data());
        array.insert(array.end(), first, first + piece / sizeof(T));
        done += piece;
        const uint64_t read_up_to = section.offset + done;
        if (read_up_to - given_back < kBytesAtOnce && done < section.bytes) continue;
        for_whole_pages(given_back, read_up_to, [&](uint64_t from, uint64_t length) {
            fallocate(fd, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(from), static_cast<off_t>(length));
        });
        given_back = read_up_to;
    }
    return true;
}

template <class T>
bool move_from_file(int fd, const Section& section, std::vector<char>& buffer, SharedArray<T>& array) {
    return move_from_file(fd, section, buffer, array.own());
}

std::string read_header(int fd, uint64_t size, Header& header) {
    if (size < sizeof header) return "the shared memory holds " + std::to_string(size) + " bytes, less than its header";
    if (!copy_from_file(fd, 0, &header, sizeof header)) return kUnreadable;
    if (header.magic != kMagic) return "the shared memory holds no scene";
    if (header.total_bytes != size) return "the shared memory's size is not the one in its header";
    return {};
}

// Fills the arrays of a scene: take(section, array) returns whether it could read the section.
template <class Take>
std::string take_sections(const Header& header, Scene& scene, Take&& take) {
    Converted converted;
    uint32_t section = 0;
    std::string why;
    visit(scene, converted, [&](auto& array) {
        using Element = typename std::decay_t<decltype(array)>::value_type;
        const Section& s = header.sections[section++];
        const uint64_t size = header.total_bytes;
        if (s.offset % kPieceAlignment != 0 || s.offset > size || s.bytes > size - s.offset || s.bytes % sizeof(Element) != 0) {
            why = "section " + std::to_string(section - 1) + " of the shared memory is out of range";
        }
        if (why.empty() && !take(s, array)) why = kUnreadable;
    });
    if (why.empty() && !convert_back(converted, scene)) why = "the names in the shared memory do not match their lengths";
    return why;
}

template <class T>
void borrow(const std::shared_ptr<const char>& bytes, const Section& section, SharedArray<T>& array) {
    array = SharedArray<T>::borrow(bytes, reinterpret_cast<const T*>(bytes.get() + section.offset), section.bytes / sizeof(T));
}
template <class T>
void borrow(const std::shared_ptr<const char>& bytes, const Section& section, std::vector<T>& array) {
    const T* const first = reinterpret_cast<const T*>(bytes.get() + section.offset);
    array.assign(first, first + section.bytes / sizeof(T));
}

}  // namespace

std::string write_scene(int fd, Scene scene) {
    Converted converted = convert(scene);
    Header header{};
    header.magic = kMagic;
    uint64_t offset = sizeof header;
    uint32_t section = 0;
    const auto padding = [&] { return (kPieceAlignment - offset % kPieceAlignment) % kPieceAlignment; };
    visit(scene, converted, [&](const auto& array) {
        using Element = typename std::decay_t<decltype(array)>::value_type;
        static_assert(std::is_trivially_copyable_v<Element>, "only plain data goes through shared memory");
        offset += padding();
        header.sections[section++] = {offset, array.size() * sizeof(Element)};
        offset += array.size() * sizeof(Element);
    });
    header.total_bytes = offset;
    std::string why = append(fd, reinterpret_cast<const char*>(&header), sizeof header);
    offset = sizeof header;
    section = 0;
    visit(scene, converted, [&](auto& array) {
        static const char zeros[kPieceAlignment] = {};
        if (why.empty()) why = append(fd, zeros, padding());
        if (why.empty()) why = move_to_file(fd, array);
        offset = header.sections[section].offset + header.sections[section].bytes;
        ++section;
    });
    if (!why.empty()) return why;
    if (fcntl(fd, F_ADD_SEALS, kSeals) != 0) return std::string("cannot seal the shared memory: ") + std::strerror(errno);
    return {};
}

std::string read_scene(int fd, Scene& scene) {
    struct stat status {};
    if (fstat(fd, &status) != 0) return std::strerror(errno);
    const uint64_t size = static_cast<uint64_t>(status.st_size);
    const int seals = fcntl(fd, F_GET_SEALS);
    if (seals < 0 || (seals & kSeals) != kSeals) return "the shared memory is not sealed";
    Header header;
    const std::string why = read_header(fd, size, header);
    if (!why.empty()) return why;
    std::vector<char> buffer;
    return take_sections(header, scene, [&](const Section& s, auto& array) { return move_from_file(fd, s, buffer, array); });
}

std::string map_scene(const MemoryFile& file, Scene& scene) {
    if (!file.sealed()) return "the shared memory is not sealed";
    Header header;
    const std::string why = read_header(file.fd(), file.bytes(), header);
    if (!why.empty()) return why;
    const std::shared_ptr<const char> bytes = map_file(file.fd(), header.total_bytes);
    return take_sections(header, scene, [&](const Section& s, auto& array) {
        borrow(bytes, s, array);
        return true;
    });
}

}  // namespace clarity::import
