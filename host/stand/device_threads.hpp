// device_threads.hpp -- one host thread for each device, so that no device waits for another one's host work.
#pragma once
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace clarity {

// run() is called from one thread.
class DeviceThreads {
 public:
    // The thread that calls run() is the first of `count`; this starts the others.
    explicit DeviceThreads(size_t count);
    ~DeviceThreads();
    DeviceThreads(const DeviceThreads&) = delete;
    DeviceThreads& operator=(const DeviceThreads&) = delete;

    // Calls work(i) for each i below the count, in parallel. Returns when all are done, with the exception of each; null: none.
    std::vector<std::exception_ptr> run(const std::function<void(size_t)>& work);
    // Calls work(only) alone, on the caller's thread: no other one has to wake.
    std::vector<std::exception_ptr> run(const std::function<void(size_t)>& work, size_t only);

 private:
    void serve(size_t index);
    void call(size_t index);

    const std::function<void(size_t)>* work_ = nullptr;
    std::vector<std::exception_ptr> thrown_;
    std::mutex mutex_;
    std::condition_variable begun_, done_;
    unsigned round_ = 0;  // a new number means that there is work
    size_t busy_ = 0;
    bool stop_ = false;
    std::vector<std::thread> threads_;  // last, because the threads use all members above
};

}  // namespace clarity
