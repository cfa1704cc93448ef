// shared_array.hpp -- an array that copies of a scene share until one of them is changed.
//
// A scene in another pose, or without some of its instances, has the same vertices and texels as the scene that it is made of.
// Copying a SharedArray copies a pointer. Reading is as with a std::vector; changing goes through own(), or through a function
// that calls it, and copies the elements first if another array shares them. Copies may be read, copied and destroyed on other
// threads.
#pragma once
#include <atomic>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

namespace clarity {

template <class T>
class SharedArray {
 public:
    using value_type = T;
    using const_iterator = typename std::vector<T>::const_iterator;

    SharedArray() = default;
    SharedArray(std::vector<T> values) : values_(std::make_shared<std::vector<T>>(std::move(values))) {}
    SharedArray(std::initializer_list<T> values) : SharedArray(std::vector<T>(values)) {}

    const std::vector<T>& all() const { return values_ ? *values_ : none(); }
    operator const std::vector<T>&() const { return all(); }
    size_t size() const { return all().size(); }
    bool empty() const { return all().empty(); }
    const T* data() const { return all().data(); }
    const T& operator[](size_t i) const { return all()[i]; }
    const T& front() const { return all().front(); }
    const T& back() const { return all().back(); }
    const_iterator begin() const { return all().begin(); }
    const_iterator end() const { return all().end(); }
    bool operator==(const SharedArray& b) const { return values_ == b.values_ || all() == b.all(); }
    bool operator!=(const SharedArray& b) const { return !(*this == b); }
    // Whether both are one array in memory.
    bool shares(const SharedArray& b) const { return values_ == b.values_; }

    // The elements, to be changed. The reference is valid until this array is copied.
    std::vector<T>& own() {
        if (!values_)
            values_ = std::make_shared<std::vector<T>>();
        else if (values_.use_count() != 1)
            values_ = std::make_shared<std::vector<T>>(*values_);
        else
            std::atomic_thread_fence(std::memory_order_acquire);  // another thread may just have let go of it
        return *values_;
    }
    void push_back(const T& value) { own().push_back(value); }
    void reserve(size_t count) { own().reserve(count); }
    void resize(size_t count) { own().resize(count); }
    void resize(size_t count, const T& value) { own().resize(count, value); }
    void assign(size_t count, const T& value) { values_ = std::make_shared<std::vector<T>>(count, value); }
    template <class Iterator>
    void append(Iterator first, Iterator last) {
        own().insert(values_->end(), first, last);
    }
    void clear() { values_.reset(); }

 private:
    static const std::vector<T>& none() {
        static const std::vector<T> empty;
        return empty;
    }
    std::shared_ptr<std::vector<T>> values_;
};

}  // namespace clarity
