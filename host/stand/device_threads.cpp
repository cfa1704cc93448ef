#include "stand/device_threads.hpp"

namespace clarity {

DeviceThreads::DeviceThreads(size_t count) : thrown_(count) {
    for (size_t i = 1; i < count; ++i) threads_.emplace_back([this, i] { serve(i); });
}

DeviceThreads::~DeviceThreads() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stop_ = true;
    }
    begun_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

std::vector<std::exception_ptr> DeviceThreads::run(const std::function<void(size_t)>& work) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        work_ = &work;
        busy_ = threads_.size();
        ++round_;
    }
    begun_.notify_all();
    call(0);
    std::unique_lock<std::mutex> lock(mutex_);
    done_.wait(lock, [this] { return busy_ == 0; });
    return thrown_;
}

std::vector<std::exception_ptr> DeviceThreads::run(const std::function<void(size_t)>& work, size_t only) {
    thrown_.assign(thrown_.size(), nullptr);
    work_ = &work;
    call(only);
    return thrown_;
}

void DeviceThreads::call(size_t index) {
    thrown_[index] = nullptr;
    try {
        (*work_)(index);
    } catch (...) {
        thrown_[index] = std::current_exception();
    }
}

void DeviceThreads::serve(size_t index) {
    for (unsigned seen = 0;;) {
        {
            std::unique_lock<std::mutex> lock(mutex_);
            begun_.wait(lock, [&] { return stop_ || round_ != seen; });
            if (stop_) return;
            seen = round_;
        }
        call(index);
        bool last = false;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            last = --busy_ == 0;
        }
        if (last) done_.notify_one();
    }
}

}  // namespace clarity
