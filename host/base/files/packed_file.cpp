#include "base/files/packed_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <vector>

#include "base/text.hpp"

namespace clarity {
namespace {

constexpr unsigned char kMagic[3] = {0x1F, 0x8B, 8};  // 8: deflate, the only method

// An open regular file; get() is negative if there is none.
class Packed {
 public:
    explicit Packed(const std::string& path) : file_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
        struct stat status{};
        if (file_ >= 0 && fstat(file_, &status) == 0 && S_ISREG(status.st_mode)) bytes_ = static_cast<uint64_t>(status.st_size);
    }
    ~Packed() {
        if (file_ >= 0) close(file_);
    }
    Packed(const Packed&) = delete;
    Packed& operator=(const Packed&) = delete;
    uint64_t bytes() const { return bytes_; }
    // Returns how many bytes were read at `at`; fewer than asked for at the end or if the file cannot be read.
    size_t read_at(uint64_t at, unsigned char* to, size_t bytes) const {
        size_t done = 0;
        while (done < bytes) {
            const ssize_t got = pread(file_, to + done, bytes - done, static_cast<off_t>(at + done));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) break;
            done += static_cast<size_t>(got);
        }
        return done;
    }
    bool is_packed() const {
        unsigned char head[3];
        return read_at(0, head, 3) == 3 && std::memcmp(head, kMagic, 3) == 0;
    }

 private:
    const int file_;
    uint64_t bytes_ = 0;
};

struct Stream : z_stream {
    Stream() : z_stream{} { state = inflateInit2(this, MAX_WBITS + 16); }
    ~Stream() { inflateEnd(this); }
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    int state;
};

const std::string kAgain = "; copy it again, or pack it again";

// Appends the plain bytes to `content` until there are `most`, or more than that if the file has them.
Problem unpack(const Packed& file, uint64_t most, const std::function<void(float)>& progress, std::string& content) {
    constexpr size_t kPiece = 1 << 18;
    std::vector<unsigned char> packed(kPiece), plain(kPiece);
    Stream stream;
    uint64_t at = 0;
    while (content.size() <= most) {
        if (stream.avail_in == 0) {
            const size_t got = file.read_at(at, packed.data(), packed.size());
            if (got == 0)
                return "is packed with gzip, and its data end too early after " + std::to_string(content.size()) +
                       " bytes: it is cut off" + kAgain;
            at += got;
            stream.next_in = packed.data();
            stream.avail_in = static_cast<uInt>(got);
        }
        stream.next_out = plain.data();
        stream.avail_out = kPiece;
        stream.state = inflate(&stream, Z_NO_FLUSH);
        if (stream.state == Z_MEM_ERROR) throw std::bad_alloc();
        content.append(reinterpret_cast<const char*>(plain.data()), kPiece - stream.avail_out);
        if (progress && file.bytes() > 0)
            progress(static_cast<float>(static_cast<double>(std::min(at, file.bytes())) / static_cast<double>(file.bytes())));
        if (stream.state == Z_STREAM_END) {
            // A file may have several parts (RFC 1952, 2.2). What else follows is left out, as gzip does.
            unsigned char next[3];
            const uint64_t behind = at - stream.avail_in;
            if (file.read_at(behind, next, 3) < 3 || std::memcmp(next, kMagic, 3) != 0) return {};
            inflateReset(&stream);
        } else if (stream.state != Z_OK && stream.state != Z_BUF_ERROR) {
            return std::string("is packed with gzip, and its data are damaged after ") + std::to_string(content.size()) +
                   " bytes (" + (stream.msg ? stream.msg : "no reason known") + ")" + kAgain;
        }
    }
    return {};
}

}  // namespace

bool is_packed(const std::string& path) {
    return Packed(path).is_packed();
}

std::string name_without_gz(const std::string& path) {
    const bool named = path.size() > 3 && lower(path.substr(path.size() - 3)) == ".gz";
    return named ? path.substr(0, path.size() - 3) : path;
}

uint64_t most_unpacked_bytes(uint64_t packed_bytes) {
    return std::max(uint64_t(1) << 30, 64 * std::min(packed_bytes, uint64_t(1) << 40));
}

uint64_t stated_content_bytes(const std::string& path) {
    const Packed file(path);
    unsigned char size[4];  // of the last part, modulo 2^32
    if (file.bytes() < 18 || !file.is_packed() || file.read_at(file.bytes() - 4, size, 4) < 4) return file.bytes();
    const uint64_t stated = size[0] | size[1] << 8 | size[2] << 16 | uint64_t(size[3]) << 24;
    return std::min(std::max(stated, file.bytes()), most_unpacked_bytes(file.bytes()));
}

Problem unpack_head(const std::string& path, uint64_t most, std::string& content) {
    content.clear();
    Problem why = unpack(Packed(path), most, {}, content);
    if (content.size() > most) content.resize(most);
    return why;
}

Problem unpack_file(const std::string& path, const std::function<void(float)>& progress, std::string& content) {
    content.clear();
    const Packed file(path);
    const uint64_t most = most_unpacked_bytes(file.bytes());
    try {
        content.reserve(stated_content_bytes(path));
    } catch (const std::bad_alloc&) {  // the size is only stated: it may be wrong
    } catch (const std::length_error&) {
    }
    try {
        Problem why = unpack(file, most, progress, content);
        if (!why && content.size() > most)
            return "is packed with gzip, and unpacks to more than " + memory_limit_text(most) +
                   ", as no model does: it is not read; if it is sound, unpack it first (gunzip -k)";
        return why;
    } catch (const std::bad_alloc&) {
        const std::string bytes = std::to_string(content.size());
        std::string().swap(content);
        return "is packed with gzip, and unpacks to more than " + bytes + " bytes, for which an import has no memory";
    }
}

}  // namespace clarity
