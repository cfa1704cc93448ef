// guarded_memory.hpp -- memory between pages that nobody may touch, so that an overrun ends the process at once.
#pragma once
#include <cstddef>
#include <string>
#include <utility>

namespace clarity {

// A block whose end lies against a page without access; another such page lies before it. Used in worker processes, where a
// crash names the block (worker/child.hpp). The few bytes between the block and the pages are filled with a pattern.
class GuardedBytes {
 public:
    GuardedBytes() = default;
    // name: for the message, "slot bvh2_nodes". The memory is zeroed and aligned to `align` bytes, a power of two of at most
    // 4096. element: bytes of an element of the array, which a crash then counts; 0: no array. Throws std::bad_alloc.
    GuardedBytes(size_t bytes, const std::string& name, size_t align = 128, size_t element = 0);
    GuardedBytes(GuardedBytes&& o) noexcept { swap(o); }
    GuardedBytes& operator=(GuardedBytes&& o) noexcept {
        swap(o);
        return *this;
    }
    ~GuardedBytes();

    void* data() { return data_; }
    const void* data() const { return data_; }
    size_t bytes() const { return bytes_; }
    const std::string& name() const { return name_; }
    // Whether the pattern beside the block is still there.
    bool intact() const;
    // From now on a write ends the process.
    void make_read_only();

 private:
    void swap(GuardedBytes& o) noexcept {
        std::swap(map_, o.map_);
        std::swap(map_bytes_, o.map_bytes_);
        std::swap(guard_, o.guard_);
        std::swap(data_, o.data_);
        std::swap(bytes_, o.bytes_);
        std::swap(name_, o.name_);
    }
    unsigned char* map_ = nullptr;  // with the guard pages
    size_t map_bytes_ = 0;
    size_t guard_ = 0;  // bytes of the pages on either side
    unsigned char* data_ = nullptr;
    size_t bytes_ = 0;
    std::string name_;
};

}  // namespace clarity
