// device_threads.hpp -- a host thread for each device, so that none waits for another's.
#pragma once
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace clarity {

class DeviceThreads {
 public:
    // The first of `count` is whoever calls run().
    explicit DeviceThreads(size_t count);
    ~DeviceThreads();
    DeviceThreads(const DeviceThreads&) = delete;
    DeviceThreads& operator=(const DeviceThreads&) = delete;

    // work(i) for each i below the count, side by side; returns when all are done, with what each threw, null where nothing.
    std::vector<std::exception_ptr> run(const std::function<void(size_t)>& work);

 private:
    void serve(size_t index);
    void call(size_t index);

    const std::function<void(size_t)>* work_ = nullptr;
    std::vector<std::exception_ptr> thrown_;
    std::mutex mutex_;
    std::condition_variable begun_, done_;
    unsigned round_ = 0;  // a new number: there is work
    size_t busy_ = 0;
    bool stop_ = false;
    std::vector<std::thread> threads_;  // last: they see the rest complete
};

}  // namespace clarity
