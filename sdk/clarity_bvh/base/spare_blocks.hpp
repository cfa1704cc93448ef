// spare_blocks.hpp -- freed blocks of memory, kept for the next build.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <system_error>
#include <thread>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace clarity::bvh {

// Keeps freed blocks in the order of their release. Without it, memory would go back to the system, which clears the pages
// again for the next allocation. Building the same scene again asks for blocks of the same sizes.
//
// Pages of large blocks that nobody has taken for kIdle are offered to the system, which takes them back when memory is short.
// They are not offered at once: a kernel that reclaims in the background would take them between two builds, and builds of 50
// to 100 thousand triangles took twice as long.
//
// Thread-safe. Never destroyed while the program runs: static objects may free memory after main, and a thread waits.
class SpareBlocks {
 public:
    using Clock = std::chrono::steady_clock;
    using Release = void (*)(void*, size_t bytes);           // gives memory back to the system
    static constexpr size_t kLarge = size_t{1} << 21;        // in bytes: of a large page
    static constexpr std::chrono::milliseconds kIdle{5000};  // jemalloc's decay is 10 s

    SpareBlocks(size_t most_bytes, Release release, Clock::duration idle = kIdle)
        : most_(most_bytes), release_(release), idle_(idle) {}

    // The latest block of exactly this size, or nullptr. Its content is undefined.
    void* take(size_t bytes) {
        const std::lock_guard<std::mutex> lock(mutex_);
        for (size_t i = count_; i-- > 0;)
            if (blocks_[i].bytes == bytes) return remove(i);
        return nullptr;
    }
    void give(void* p, size_t bytes) {
        if (bytes > most_) return release_(p, bytes);
        const std::lock_guard<std::mutex> lock(mutex_);
        while (count_ == kMost || sum_ + bytes > most_) {
            const size_t oldest = blocks_[0].bytes;
            release_(remove(0), oldest);
        }
        blocks_[count_++] = {p, bytes, Clock::now(), bytes < kLarge};
        sum_ += bytes;
        if (bytes >= kLarge && !waits_) start_waiting();
    }
    size_t sum() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return sum_;
    }
    // Bytes of large blocks that the system may take.
    size_t offered() {
        const std::lock_guard<std::mutex> lock(mutex_);
        size_t bytes = 0;
        for (size_t i = 0; i < count_; ++i)
            if (blocks_[i].offered && blocks_[i].bytes >= kLarge) bytes += blocks_[i].bytes;
        return bytes;
    }

 private:
    struct Block {
        void* p;
        size_t bytes;
        Clock::time_point since;
        bool offered;  // or small
    };
    static constexpr size_t kMost = 24;

    void* remove(size_t i) {
        void* const p = blocks_[i].p;
        sum_ -= blocks_[i].bytes;
        std::copy(blocks_ + i + 1, blocks_ + count_, blocks_ + i);
        --count_;
        return p;
    }
    // One thread waits as long as there is something to offer. Where none can be started, memory is offered at once.
    void start_waiting() {
        try {
            std::thread([this] { wait(); }).detach();
            waits_ = true;
        } catch (const std::system_error&) {
            offer(Clock::time_point::max());
        }
    }
    void wait() {
        std::unique_lock<std::mutex> lock(mutex_);
        for (;;) {
            const Clock::time_point next = offer(Clock::now() - idle_);
            if (next == Clock::time_point::max()) break;
            lock.unlock();
            std::this_thread::sleep_until(next + idle_);
            lock.lock();
        }
        waits_ = false;
    }
    // Offers the blocks that were freed until `before`. Returns when the first one of the others was freed.
    Clock::time_point offer(Clock::time_point before) {
        Clock::time_point next = Clock::time_point::max();
        for (size_t i = 0; i < count_; ++i) {
            Block& block = blocks_[i];
            if (block.offered) continue;
            if (block.since > before) {
                next = std::min(next, block.since);
                continue;
            }
#ifdef MADV_FREE
            madvise(block.p, block.bytes, MADV_FREE);  // the system may take the pages, and reads then give zeros
#endif
            block.offered = true;
        }
        return next;
    }

    const size_t most_;
    const Release release_;
    const Clock::duration idle_;
    std::mutex mutex_;
    Block blocks_[kMost];
    size_t count_ = 0, sum_ = 0;
    bool waits_ = false;
};

}  // namespace clarity::bvh
