// pending_write.hpp -- whether a file is being made, so that a program that has to end gives it the time.
#pragma once
#include <atomic>

namespace clarity {

// Exists from the first step of making a file, its encoding, to the last. Any thread may have some.
class PendingWrite {
 public:
    PendingWrite() { ++count(); }
    ~PendingWrite() { --count(); }
    PendingWrite(const PendingWrite&) = delete;
    PendingWrite& operator=(const PendingWrite&) = delete;
    // Whether there is one in this process.
    static bool any() { return count() > 0; }

 private:
    static std::atomic<int>& count() {
        static std::atomic<int> writes{0};
        return writes;
    }
};

}  // namespace clarity
