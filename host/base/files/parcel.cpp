#include "base/files/parcel.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>

namespace clarity {
namespace {

// Bytes that both processes hold at the same time while an array goes from one to the other.
constexpr uint64_t kBytesAtOnce = uint64_t(4) << 20;
constexpr uint64_t kBytesAhead = uint64_t(4) << 10;

uint64_t padding_at(uint64_t at) {
    return (kParcelAlignment - at % kParcelAlignment) % kParcelAlignment;
}

// The whole pages within a range of addresses or offsets.
template <class Body>
void for_whole_pages(uint64_t first, uint64_t end, const Body& body) {
    static const uint64_t page = static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
    first = (first + page - 1) / page * page;
    end = end / page * page;
    if (first < end) body(first, end - first);
}

}  // namespace

void detail::advise_large_pages(void* data, uint64_t bytes) {
    constexpr uintptr_t kLargePage = 2u << 20;
    const uintptr_t first = (reinterpret_cast<uintptr_t>(data) + kLargePage - 1) / kLargePage * kLargePage;
    const uintptr_t last = (reinterpret_cast<uintptr_t>(data) + bytes) / kLargePage * kLargePage;
    if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
}

void ParcelWriter::append(const void* data, uint64_t count) {
    waiting_.append(static_cast<const char*>(data), count);
    if (waiting_.size() >= (size_t(64) << 10)) flush();
}

void ParcelWriter::pad() {
    waiting_.append(padding_at(at_ + waiting_.size()), '\0');
}

void ParcelWriter::flush() {
    file_.write_at(at_, waiting_.data(), waiting_.size());
    at_ += waiting_.size();
    waiting_.clear();
}

void ParcelWriter::bytes(const void* data, uint64_t count, bool gives_back) {
    plain(count);
    pad();
    if (count < 4096) {
        append(data, count);
    } else {
        flush();
        for (uint64_t done = 0; done < count;) {
            const uint64_t piece = gives_back ? std::min(kBytesAtOnce, count - done) : count - done;
            file_.write_at(at_, static_cast<const char*>(data) + done, piece);
            const uint64_t address = reinterpret_cast<uintptr_t>(data) + done;
            if (gives_back)
                for_whole_pages(address, address + piece, [](uint64_t first, uint64_t length) {
                    madvise(reinterpret_cast<void*>(first), length, MADV_DONTNEED);
                });
            at_ += piece;
            done += piece;
        }
    }
    pad();
}

void ParcelWriter::finish() {
    flush();
    file_.seal_size();
}

ParcelReader::ParcelReader(const MemoryFile& file, How how) : file_(file), how_(how), bytes_(file.bytes()) {
    if (how == How::mapped ? !file.sealed() : !file.size_sealed()) throw Error(Exit::failed, "the shared memory is not sealed");
    if (how == How::mapped && bytes_ > 0) memory_ = map_file(file.fd(), bytes_);
}

uint64_t ParcelReader::checked(uint64_t count) const {
    if (count > bytes_ - at_) throw ParcelDamaged();
    return count;
}

void ParcelReader::read(void* to, uint64_t count, bool of_array) {
    checked(count);
    if (count == 0) return;
    if (memory_) {
        std::memcpy(to, memory_.get() + at_, count);
    } else if (of_array || count > kBytesAhead) {
        file_.read_at(at_, to, count);
    } else {
        if (at_ < ahead_at_ || at_ + count > ahead_at_ + ahead_.size()) {
            ahead_.resize(std::min(kBytesAhead, bytes_ - at_));
            file_.read_at(ahead_at_ = at_, ahead_.data(), ahead_.size());
        }
        std::memcpy(to, ahead_.data() + (at_ - ahead_at_), count);
    }
    at_ += count;
    if (!of_array || how_ != How::emptied || at_ - given_back_ < kBytesAtOnce) return;
    for_whole_pages(given_back_, at_, [&](uint64_t from, uint64_t length) {
        fallocate(file_.fd(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(from), static_cast<off_t>(length));
    });
    given_back_ = at_;
}

void ParcelReader::skip_padding() {
    at_ += checked(padding_at(at_));
}

uint64_t ParcelReader::begin_array() {
    const uint64_t count = number();
    skip_padding();
    return checked(count);
}

void ParcelReader::end_array() {
    skip_padding();
}

const char* ParcelReader::borrow(uint64_t count) {
    const char* const here = memory_.get() + at_;
    at_ += checked(count);
    end_array();
    return here;
}

void ParcelReader::end() const {
    if (at_ != bytes_) throw ParcelDamaged();
}

}  // namespace clarity
