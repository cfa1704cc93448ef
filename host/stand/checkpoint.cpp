#include "stand/checkpoint.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "rt_types.h"

namespace clarity {
namespace {

using CheckpointJson = nlohmann::ordered_json;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are written as they are in memory");
constexpr char kCheckpointMagic[9] = "ClCheck1";
constexpr uint64_t kMostHeadBytes = 1 << 20, kDigestBytes = 32;

// A file that ends with the digest of all its bytes.
class CheckedWriter {
 public:
    explicit CheckedWriter(const std::string& path) : file_(path) {}
    void write(const void* data, size_t bytes) {
        digest_.add_bytes(data, bytes);
        file_.write(data, bytes);
    }
    void commit() {
        const std::string digest = digest_.hex();
        file_.write(digest.data(), digest.size());
        file_.sync();
        file_.commit();
    }

 private:
    OutputFile file_;
    Digest digest_;
};

[[noreturn]] void refuse_checkpoint(const std::string& path, const std::string& why) {
    throw Error(Exit::failed, path + ": no checkpoint to go on from: " + why +
                                  "; leave --resume out to begin the picture anew, or name another file");
}

}  // namespace

void save_checkpoint(const std::string& path, const Checkpoint& checkpoint) {
    const FloatImage& sums = *checkpoint.sums;
    CheckpointJson json = {{"picture", checkpoint.picture}, {"way", checkpoint.way},
                           {"width", sums.width},           {"height", sums.height / checkpoint.planes},
                           {"samples", checkpoint.samples}, {"of", checkpoint.of}};
    if (checkpoint.planes > 1) json["planes"] = checkpoint.planes;
    const std::string head = json.dump(2, ' ', false, CheckpointJson::error_handler_t::replace) + "\n";
    const uint64_t head_bytes = head.size();
    CheckedWriter file(path);
    file.write(kCheckpointMagic, 8);
    file.write(&head_bytes, sizeof head_bytes);
    file.write(head.data(), head.size());
    file.write(sums.pixels.data(), sums.pixels.size() * sizeof(float));
    file.commit();
}

Checkpoint load_checkpoint(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse_checkpoint(path, std::strerror(errno));
    Digest digest;
    const auto read = [&](void* to, size_t bytes) {
        file.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes));
        if (size_t(file.gcount()) != bytes) refuse_checkpoint(path, "it ends too early, so it is damaged");
        digest.add_bytes(to, bytes);
    };
    file.seekg(0, std::ios::end);
    const auto size = uint64_t(std::max<std::streamoff>(0, file.tellg()));
    file.seekg(0);
    char magic[8] = {};
    uint64_t head_bytes = 0;
    if (size < sizeof magic + sizeof head_bytes) refuse_checkpoint(path, "it is too short to be one");
    read(magic, sizeof magic);
    if (std::memcmp(magic, kCheckpointMagic, sizeof magic) != 0) refuse_checkpoint(path, "it is a file of another kind");
    read(&head_bytes, sizeof head_bytes);
    if (head_bytes > kMostHeadBytes) refuse_checkpoint(path, "its head is damaged");
    std::string head(head_bytes, ' ');
    read(head.data(), head.size());
    Checkpoint checkpoint;
    FloatImage sums;
    sums.channels = 4;
    try {
        const CheckpointJson json = CheckpointJson::parse(head);
        checkpoint.picture = json.at("picture").get<std::string>();
        checkpoint.way = json.at("way").get<std::string>();
        checkpoint.samples = json.at("samples").get<unsigned>();
        checkpoint.of = json.at("of").get<unsigned>();
        sums.width = json.at("width").get<unsigned>();
        checkpoint.planes = json.value("planes", 1u);
        if (checkpoint.planes < 1 || checkpoint.planes > RT_FILM_PLANES) refuse_checkpoint(path, "its head is damaged");
        sums.height = json.at("height").get<unsigned>() * checkpoint.planes;
    } catch (const CheckpointJson::exception&) {
        refuse_checkpoint(path, "its head is damaged");
    }
    const uint64_t pixels = uint64_t(sums.width) * sums.height, before = sizeof magic + sizeof head_bytes + head_bytes;
    // Memory is taken only for what the file holds.
    if (pixels > size / 16 || size != before + pixels * 16 + kDigestBytes)
        refuse_checkpoint(path, "its size is not that of its picture, so it is damaged");
    sums.pixels.resize(pixels * 4);
    read(sums.pixels.data(), sums.pixels.size() * sizeof(float));
    const std::string expected = digest.hex();
    std::string found(kDigestBytes, ' ');
    read(found.data(), found.size());
    if (found != expected) refuse_checkpoint(path, "its content is not what was written, so it is damaged");
    checkpoint.sums = std::make_shared<const FloatImage>(std::move(sums));
    return checkpoint;
}

}  // namespace clarity
