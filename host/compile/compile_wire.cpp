// A job or an outcome is a row of numbers and of texts; each text stands behind its length, 8 bytes.
#include "compile/compile_wire.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace clarity {
namespace {

constexpr uint64_t kMostWireBytes = uint64_t{1} << 30;

class WireText {
 public:
    template <class Text>
    void text(const Text& value) {
        number(uint64_t(value.size()));
        bytes_.append(value.data(), value.size());
    }
    template <class Number>
    void number(const Number& value) {
        static_assert(std::is_trivially_copyable_v<Number>);
        bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    std::string write_to(int fd) const {
        if (ftruncate(fd, 0) != 0) return std::string("shared memory: ") + std::strerror(errno);
        for (size_t at = 0; at < bytes_.size();) {
            const ssize_t written = pwrite(fd, bytes_.data() + at, bytes_.size() - at, static_cast<off_t>(at));
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) return std::string("shared memory: ") + std::strerror(errno);
            at += static_cast<size_t>(written);
        }
        return {};
    }

 private:
    std::string bytes_;
};

class WireReader {
 public:
    explicit WireReader(int fd) {
        struct stat status {};
        if (fstat(fd, &status) != 0 || status.st_size < 0 || uint64_t(status.st_size) > kMostWireBytes) return;
        bytes_.resize(size_t(status.st_size));
        for (size_t at = 0; at < bytes_.size();) {
            const ssize_t got = pread(fd, bytes_.data() + at, bytes_.size() - at, static_cast<off_t>(at));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) return;
            at += static_cast<size_t>(got);
        }
        sound_ = true;
    }
    template <class Number>
    void number(Number& value) {
        static_assert(std::is_trivially_copyable_v<Number>);
        if (!holds(sizeof value)) return;
        std::memcpy(&value, bytes_.data() + at_, sizeof value);
        at_ += sizeof value;
    }
    template <class Text>
    void text(Text& value) {
        uint64_t length = 0;
        number(length);
        if (!holds(length)) return;
        value.assign(bytes_.begin() + static_cast<ptrdiff_t>(at_), bytes_.begin() + static_cast<ptrdiff_t>(at_ + length));
        at_ += length;
    }
    std::string end() const { return sound_ && at_ == bytes_.size() ? std::string() : "the shared memory is damaged"; }

 private:
    bool holds(uint64_t bytes) { return sound_ = sound_ && bytes <= bytes_.size() - at_; }
    std::string bytes_;
    size_t at_ = 0;
    bool sound_ = false;
};

}  // namespace

std::string write_compile_job(int fd, const CompileJob& job) {
    WireText out;
    for (const std::string* text : {&job.source, &job.options, &job.device, &job.name, &job.driver, &job.pocl_cache})
        out.text(*text);
    out.number(job.ends_on_zeros);
    out.number(job.wants_binary);
    return out.write_to(fd);
}

std::string read_compile_job(int fd, CompileJob& job) {
    WireReader in(fd);
    for (std::string* text : {&job.source, &job.options, &job.device, &job.name, &job.driver, &job.pocl_cache}) in.text(*text);
    in.number(job.ends_on_zeros);
    in.number(job.wants_binary);
    return in.end();
}

std::string write_compile_outcome(int fd, const CompileOutcome& outcome) {
    WireText out;
    out.number(outcome.state);
    out.number(outcome.error);
    out.text(outcome.log);
    out.text(outcome.binary);
    return out.write_to(fd);
}

std::string read_compile_outcome(int fd, CompileOutcome& outcome) {
    WireReader in(fd);
    in.number(outcome.state);
    in.number(outcome.error);
    in.text(outcome.log);
    in.text(outcome.binary);
    return in.end();
}

}  // namespace clarity
