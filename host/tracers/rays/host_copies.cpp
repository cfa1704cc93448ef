#include "tracers/rays/host_copies.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/parallel_for.hpp"
#include "device/launch_limit.hpp"

namespace clarity {
namespace {

// Bytes; up to here the driver's own copy is as fast, and all arrays come in one. To wait for it takes longer than the copy.
constexpr size_t kSmall = size_t{1} << 16;
constexpr size_t kPiece = size_t{1} << 22;  // bytes; a multiple of a block of rays of any number of lanes
constexpr size_t kPart = size_t{1} << 18;   // bytes that one core copies
constexpr const char* kWaiting = "a copy between the device and the host";

// A piece on the bus.
struct Flight {
    std::shared_ptr<uint8_t> memory;
    cl::Event done;
    size_t before = 0, bytes = 0;
};

// Work on bytes [0, bytes), by all cores where that pays.
void for_parts(size_t bytes, const std::function<void(size_t begin, size_t end)>& work) {
    if (bytes <= kPart) {
        work(0, bytes);
        return;
    }
    parallel_for(static_cast<uint32_t>((bytes + kPart - 1) / kPart),
                 [&](uint32_t i) { work(i * kPart, std::min(bytes, (i + 1) * kPart)); });
}

void copy_memory(void* to, const void* from, size_t bytes) {
    for_parts(bytes, [&](size_t begin, size_t end) {
        std::memcpy(static_cast<char*>(to) + begin, static_cast<const char*>(from) + begin, end - begin);
    });
}

}  // namespace

HostCopies::~HostCopies() {
    if (device_->loss()->stuck()) never_release(std::make_shared<std::vector<unsigned char>>(std::move(small_)));
    try {
        if (sent_()) sent_.wait();
    } catch (const cl::Error&) {  // the device is lost: nothing reads this memory any more
    }
}

void HostCopies::read(const cl::Buffer& from, size_t begin, size_t bytes,
                      const std::function<void(const void*, size_t, size_t)>& take) {
    if (bytes == 0) return;
    const Queue& queue = device_->queue();
    read_ += bytes;
    const auto ahead = std::exchange(ahead_, {});
    if (bytes <= kSmall) {
        small_.resize(kSmall);
        if (begin != 0 || from() != ahead.first || bytes > ahead.second)
            queue.enqueueReadBuffer(from, CL_TRUE, begin, bytes, small_.data());
        take(small_.data(), 0, bytes);
        return;
    }
    if (device_->info().cpu) {
        void* const mapped = queue.enqueueMapBuffer(from, CL_TRUE, CL_MAP_READ, begin, bytes);
        take(mapped, 0, bytes);
        queue.enqueueUnmapMemObject(from, mapped);
        return;
    }
    std::array<Flight, 2> flights;
    const auto start = [&](size_t before) {
        if (before >= bytes) return;
        Flight& flight = flights[before / kPiece % 2];
        flight.before = before;
        flight.bytes = std::min(kPiece, bytes - before);
        if (!flight.memory) flight.memory = pinned_.lend(kPiece);
        queue.enqueueReadBuffer(from, CL_FALSE, begin + before, flight.bytes, flight.memory.get(), nullptr, &flight.done);
        queue.flush();
    };
    start(0);
    for (size_t before = 0; before < bytes; before += kPiece) {
        start(before + kPiece);
        const Flight& flight = flights[before / kPiece % 2];
        wait_for(*device_, flight.done, kWaiting);
        take(flight.memory.get(), flight.before, flight.bytes);
    }
}

cl::Event HostCopies::read_ahead(const cl::Buffer& from, size_t bytes) {
    cl::Event done;
    ahead_ = {};
    if (bytes > kSmall) return done;
    small_.resize(kSmall);
    device_->queue().enqueueReadBuffer(from, CL_FALSE, 0, bytes, small_.data(), nullptr, &done);
    ahead_ = {from(), bytes};
    return done;
}

void HostCopies::write(const cl::Buffer& to, size_t bytes, const std::function<void(void*, size_t, size_t)>& make) {
    if (bytes == 0) return;
    const Queue& queue = device_->queue();
    written_ += bytes;
    if (bytes <= kSmall) {
        if (sent_()) sent_.wait();
        small_sent_.resize(kSmall);
        make(small_sent_.data(), 0, bytes);
        queue.enqueueWriteBuffer(to, CL_FALSE, 0, bytes, small_sent_.data(), nullptr, &sent_);
        return;
    }
    if (device_->info().cpu) {
        void* const mapped = queue.enqueueMapBuffer(to, CL_TRUE, CL_MAP_WRITE_INVALIDATE_REGION, 0, bytes);
        try {
            make(mapped, 0, bytes);
        } catch (...) {
            queue.enqueueUnmapMemObject(to, mapped);
            throw;
        }
        queue.enqueueUnmapMemObject(to, mapped);
        return;
    }
    std::array<Flight, 2> flights;
    for (size_t before = 0; before < bytes; before += kPiece) {
        Flight& flight = flights[before / kPiece % 2];
        if (flight.done())
            wait_for(*device_, flight.done, kWaiting);
        else
            flight.memory = pinned_.lend(kPiece);
        const size_t some = std::min(kPiece, bytes - before);
        make(flight.memory.get(), before, some);
        queue.enqueueWriteBuffer(to, CL_FALSE, before, some, flight.memory.get(), nullptr, &flight.done);
        queue.flush();
    }
    for (const Flight& flight : flights)  // others may be lent this memory
        if (flight.done()) wait_for(*device_, flight.done, kWaiting);
}

AnswersTo AnswersTo::from(size_t ray) const {
    AnswersTo to = *this;
    for (size_t k = 0; k < kAnswerArrays; ++k)
        if (to.arrays[k]) to.arrays[k] = static_cast<float*>(arrays[k]) + ray * width_of(AnswerArray(k));
    return to;
}

void read_answers(HostCopies& copies, const Answers& answers, const AnswersTo& to) {
    const auto take = [&](size_t k, const std::function<void(size_t begin, size_t bytes)>& copy) {
        const auto array = AnswerArray(k);
        const size_t bytes = answers.count * width_of(array) * sizeof(float);
        if (first_field(array) < answers.fields)
            copy(first_field(array) * answers.stride * sizeof(float), bytes);
        else
            std::memset(to.arrays[k], array == AnswerArray::uv ? 0 : -1, bytes);
    };
    const bool wanted = std::any_of(std::begin(to.arrays), std::end(to.arrays), [](const void* array) { return array; });
    if (answers.count == 0 || !wanted) return;
    const bool at_once = answers.bytes() > 0 && answers.bytes() <= kSmall;
    const auto each = [&](const char* all) {
        for (size_t k = 0; k < kAnswerArrays; ++k)
            if (to.arrays[k])
                take(k, [&](size_t begin, size_t bytes) {
                    if (at_once)
                        std::memcpy(to.arrays[k], all + begin, bytes);
                    else
                        copies.read(answers.buffer, begin, bytes, [&](const void* piece, size_t before, size_t some) {
                            copy_memory(static_cast<char*>(to.arrays[k]) + before, piece, some);
                        });
                });
    };
    if (at_once)
        copies.read(answers.buffer, 0, answers.bytes(),
                    [&](const void* all, size_t, size_t) { each(static_cast<const char*>(all)); });
    else
        each(nullptr);
}

void read_occlusion(HostCopies& copies, const Answers& answers, uint8_t* occluded) {
    copies.read(answers.buffer, 0, answers.count * sizeof(float), [&](const void* piece, size_t before, size_t bytes) {
        const auto* const t = static_cast<const float*>(piece);
        uint8_t* const to = occluded + before / sizeof *t;
        const size_t count = bytes / sizeof *t;
        for_parts(bytes, [&](size_t begin, size_t end) {
            for (size_t i = begin / sizeof *t; i < std::min(count, end / sizeof *t); ++i) to[i] = t[i] == 0;
        });
    });
}

}  // namespace clarity
