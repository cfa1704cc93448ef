// host_copies.hpp -- copies between buffers of a device and memory of the host, a piece at a time, and answers of ray queries.
#pragma once
#include <CL/opencl.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "device/device.hpp"
#include "picture/pinned_memory_pool.hpp"

namespace clarity {

// A GPU has the next piece on the bus while all cores work on one. A CPU's buffers are the host's memory: there is one piece,
// and it is that memory. Used from one thread at a time.
class HostCopies {
 public:
    explicit HostCopies(std::shared_ptr<Device> device) : device_(device), pinned_(device) {}
    ~HostCopies();
    // take: gets the pieces of `bytes` bytes from `begin` on in their order, and how many bytes were before.
    void read(const cl::Buffer& from, size_t begin, size_t bytes,
              const std::function<void(const void* piece, size_t before, size_t bytes)>& take);
    // Enqueues the read of the first bytes, for one call of read() after the event. Null: they are too many for that.
    cl::Event read_ahead(const cl::Buffer& from, size_t bytes);
    // make: fills them in.
    void write(const cl::Buffer& to, size_t bytes, const std::function<void(void* piece, size_t before, size_t bytes)>& make);
    // What these calls have copied.
    uint64_t bytes_read() const { return read_; }
    uint64_t bytes_written() const { return written_; }
    const std::shared_ptr<Device>& device() const { return device_; }

 private:
    const std::shared_ptr<Device> device_;
    PinnedMemoryPool pinned_;
    std::vector<unsigned char> small_, small_sent_;
    std::pair<cl_mem, size_t> ahead_{};  // from where, and how many bytes, in small_
    cl::Event sent_;                     // until then the device may read small_sent_
    uint64_t read_ = 0, written_ = 0;
};

// Answers on a device: for each of `fields` numbers of an answer (cl/tracers/rays/ray_blocks.h) an array of `stride` numbers.
struct Answers {
    cl::Buffer buffer;
    size_t count = 0, stride = 0;  // rays, and numbers of an array
    size_t before = 0;             // rays of the arrays that are before the first one
    cl_uint fields = 0;
    size_t bytes() const { return stride * fields * sizeof(float); }
};

// Arrays of an answer, and where they are copied to.
enum class AnswerArray { t, prim, uv, instance };
constexpr size_t kAnswerArrays = 4;
constexpr size_t first_field(AnswerArray array) {
    return array == AnswerArray::instance ? 4 : static_cast<size_t>(array);
}
constexpr size_t width_of(AnswerArray array) {
    return array == AnswerArray::uv ? 2 : 1;
}
struct AnswersTo {
    void* arrays[kAnswerArrays] = {};  // in the order of AnswerArray; null: not wanted
    // The same from another ray on.
    AnswersTo from(size_t ray) const;
};
// Arrays that the answers do not have become 0, and -1 for numbers.
void read_answers(HostCopies& copies, const Answers& answers, const AnswersTo& to);
// 1 for rays that hit anything, else 0. The answers are those of an any-hit query.
void read_occlusion(HostCopies& copies, const Answers& answers, uint8_t* occluded);

}  // namespace clarity
