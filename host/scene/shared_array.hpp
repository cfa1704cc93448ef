// shared_array.hpp -- an array that copies of a scene share until one of them is changed.
//
// A scene in another pose, or without some of its instances, has the same vertices and texels as the scene that it is made of.
// Copying a SharedArray copies a pointer. Reading is as with a std::vector; changing goes through own(), or through a function
// that calls it, and copies the elements first if another array shares them. The elements may also lie in memory that is not
// ours, such as a file that several processes have mapped. Copies may be read, copied and destroyed on other threads.
#pragma once
#include <algorithm>
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
    using const_iterator = const T*;

    SharedArray() = default;
    SharedArray(std::vector<T> values) : values_(std::make_shared<std::vector<T>>(std::move(values))) {}
    SharedArray(std::initializer_list<T> values) : SharedArray(std::vector<T>(values)) {}
    // Elements in memory of another owner, which lives as long as this array or a copy of it.
    static SharedArray borrow(std::shared_ptr<const void> owner, const T* data, size_t count) {
        SharedArray array;
        if (count > 0) array.lender_ = std::move(owner), array.lent_ = data, array.lent_count_ = count;
        return array;
    }

    const T* data() const { return values_ ? values_->data() : lent_; }
    size_t size() const { return values_ ? values_->size() : lent_count_; }
    bool empty() const { return size() == 0; }
    const T& operator[](size_t i) const { return data()[i]; }
    const T& front() const { return data()[0]; }
    const T& back() const { return data()[size() - 1]; }
    const_iterator begin() const { return data(); }
    const_iterator end() const { return data() + size(); }
    std::vector<T> copy() const { return std::vector<T>(begin(), end()); }
    bool operator==(const SharedArray& b) const { return shares(b) || std::equal(begin(), end(), b.begin(), b.end()); }
    bool operator!=(const SharedArray& b) const { return !(*this == b); }
    // Whether both are one array in memory.
    bool shares(const SharedArray& b) const { return values_ == b.values_ && lent_ == b.lent_ && lent_count_ == b.lent_count_; }
    // Whether the elements are this array's alone, so that own() copies nothing.
    bool is_sole_owner() const { return lent_count_ == 0 && values_.use_count() <= 1; }

    // The elements, to be changed. The reference is valid until this array is copied.
    std::vector<T>& own() {
        if (is_sole_owner() && values_)
            std::atomic_thread_fence(std::memory_order_acquire);  // another thread may just have let go of it
        else
            *this = SharedArray(copy());
        return *values_;
    }
    void push_back(const T& value) { own().push_back(value); }
    void reserve(size_t count) { own().reserve(count); }
    void resize(size_t count) { own().resize(count); }
    void resize(size_t count, const T& value) { own().resize(count, value); }
    void assign(size_t count, const T& value) { *this = SharedArray(std::vector<T>(count, value)); }
    template <class Iterator>
    void append(Iterator first, Iterator last) {
        own().insert(values_->end(), first, last);
    }
    void clear() { *this = SharedArray(); }

 private:
    std::shared_ptr<std::vector<T>> values_;  // nullptr: there are no elements, or they are lent
    std::shared_ptr<const void> lender_;
    const T* lent_ = nullptr;
    size_t lent_count_ = 0;
};

}  // namespace clarity
