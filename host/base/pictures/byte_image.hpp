// byte_image.hpp -- a picture as a screen shows it.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace clarity {

// Immutable bytes of any owner. Copies share the same bytes; the last copy frees them.
class SharedBytes {
 public:
    SharedBytes() = default;
    SharedBytes(std::shared_ptr<const uint8_t> bytes, size_t size) : bytes_(std::move(bytes)), size_(size) {}
    SharedBytes(std::vector<uint8_t> bytes) : size_(bytes.size()) {
        const auto owner = std::make_shared<const std::vector<uint8_t>>(std::move(bytes));
        bytes_ = {owner, owner->data()};
    }

    const uint8_t* data() const { return bytes_.get(); }
    size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    const uint8_t* begin() const { return data(); }
    const uint8_t* end() const { return data() + size_; }
    const uint8_t& operator[](size_t i) const { return data()[i]; }
    bool operator==(const SharedBytes& other) const { return std::equal(begin(), end(), other.begin(), other.end()); }

 private:
    std::shared_ptr<const uint8_t> bytes_;
    size_t size_ = 0;
};

// RGBA8, top row first.
struct ByteImage {
    unsigned width = 0, height = 0;
    SharedBytes pixels;
};

}  // namespace clarity
