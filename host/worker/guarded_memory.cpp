#include "worker/guarded_memory.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <new>

#include "worker/child.hpp"

namespace clarity {
namespace {

// Bytes on either side. They take addresses and no memory, so there are as many as a wrong index usually leads astray. Where a
// process may not have that many addresses, as builders in their sandbox, large strides still miss more than a page.
constexpr size_t kGuards[] = {size_t(8) << 30, 1u << 20};
constexpr unsigned char kPattern = 0xA5;

}  // namespace

GuardedBytes::GuardedBytes(size_t bytes, const std::string& name, size_t align, size_t element) : bytes_(bytes), name_(name) {
    const auto page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
    const size_t room = (bytes + align - 1) / align * align, pages = (room + page - 1) / page * page;
    void* map = MAP_FAILED;
    for (const size_t guard : kGuards) {
        if (map != MAP_FAILED) break;
        guard_ = guard;
        map_bytes_ = pages + 2 * guard;
        map = mmap(nullptr, map_bytes_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    }
    if (map == MAP_FAILED) throw std::bad_alloc();
    map_ = static_cast<unsigned char*>(map);
    if (pages > 0 && mprotect(map_ + guard_, pages, PROT_READ | PROT_WRITE) != 0) {
        munmap(map, map_bytes_);
        throw std::bad_alloc();
    }
    data_ = map_ + guard_ + pages - room;
    std::memset(map_ + guard_, kPattern, static_cast<size_t>(data_ - map_) - guard_);
    std::memset(data_ + bytes, kPattern, room - bytes);
    worker::name_memory(data_, bytes_, name_, element);
}

GuardedBytes::~GuardedBytes() {
    if (!map_) return;
    worker::forget_memory(data_);
    munmap(map_, map_bytes_);
}

bool GuardedBytes::intact() const {
    if (!map_) return true;
    const auto is_pattern = [](const unsigned char* begin, const unsigned char* end) {
        for (; begin < end; ++begin)
            if (*begin != kPattern) return false;
        return true;
    };
    return is_pattern(map_ + guard_, data_) && is_pattern(data_ + bytes_, map_ + map_bytes_ - guard_);
}

void GuardedBytes::make_read_only() {
    if (map_ && map_bytes_ > 2 * guard_) mprotect(map_ + guard_, map_bytes_ - 2 * guard_, PROT_READ);
}

}  // namespace clarity
