#include "picture.hpp"

#include <climits>
#include <memory>
#include <stdexcept>

#include "../common/file_kind.hpp"
#include "../common/numbers.hpp"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65536
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace heightfield {
namespace {

constexpr std::string_view kPng = "\x89PNG";

Picture read_png(std::string_view bytes) {
    if (bytes.size() > INT_MAX) throw std::runtime_error("has more than 2 GiB, which the PNG reader does not take");
    const auto* const data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    int width = 0, height = 0, channels = 0;
    // 8 bits become 16 by 257 times the value, so shares stay what they are.
    const std::unique_ptr<stbi_us, void (*)(void*)> values(stbi_load_16_from_memory(data, size, &width, &height, &channels, 1),
                                                           stbi_image_free);
    if (!values) throw std::runtime_error(std::string("is a damaged PNG picture: ") + stbi_failure_reason());
    Picture picture{rt_u32(width), rt_u32(height), {}, {}};
    picture.samples.assign(values.get(), values.get() + size_t(width) * size_t(height));
    for (float& sample : picture.samples) sample /= 65535;
    if (channels >= 3) picture.left_out = "it is in colour: heights are its luminance";
    if (channels == 2 || channels == 4) picture.left_out += std::string(channels == 4 ? "; " : "") + "its alpha is left out";
    return picture;
}

// Source: the manual page pgm(5) of Netpbm.
class PgmReader {
 public:
    explicit PgmReader(std::string_view bytes) : bytes_(bytes), is_text_(bytes[1] == '2'), at_(2) {}

    Picture read() {
        Picture picture;
        picture.width = static_cast<rt_u32>(number("its width", 1, 65536));
        picture.height = static_cast<rt_u32>(number("its height", 1, 65536));
        const int64_t most = number("its largest value", 1, 65535);
        const size_t count = size_t(picture.width) * picture.height, width = is_text_ || most < 256 ? 1 : 2;
        if (!is_text_) ++at_;  // one blank
        // The values of a text have a blank in between.
        const size_t least = is_text_ ? 2 * count - 1 : width * count, left = bytes_.size() - std::min(at_, bytes_.size());
        if (left < least)
            throw std::runtime_error("declares " + std::to_string(count) + " samples and has " + std::to_string(left) +
                                     " bytes for them: it is cut off or damaged");
        picture.samples.resize(count);
        for (float& sample : picture.samples) {
            const int64_t value = is_text_ ? number("a sample", 0, 65535) : binary(width);
            if (value > most)
                throw std::runtime_error("byte " + std::to_string(at_) + ": found the sample " + std::to_string(value) +
                                         ", expected at most " + std::to_string(most));
            sample = static_cast<float>(value) / static_cast<float>(most);
        }
        return picture;
    }

 private:
    int64_t number(const char* what, int64_t least, int64_t most) {
        const auto is_blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
        while (at_ < bytes_.size() && (is_blank(bytes_[at_]) || bytes_[at_] == '#'))
            at_ = bytes_[at_] == '#' ? std::min(bytes_.find_first_of("\n\r", at_), bytes_.size()) : at_ + 1;
        const char *at = bytes_.data() + at_, *const end = bytes_.data() + bytes_.size();
        int64_t value = 0;
        if (!importers::read_number(at, end, value) || value < least || value > most)
            throw std::runtime_error("byte " + std::to_string(at_) + ": expected " + what + ", a number from " +
                                     std::to_string(least) + " to " + std::to_string(most));
        at_ = static_cast<size_t>(at - bytes_.data());
        return value;
    }
    int64_t binary(size_t width) {
        const char* const at = bytes_.data() + at_;
        at_ += width;
        return width == 1 ? importers::load<uint8_t>(at, true) : importers::load<uint16_t>(at, true);
    }

    std::string_view bytes_;
    bool is_text_;
    size_t at_;
};

}  // namespace

Picture read_picture(std::string_view bytes) {
    if (bytes.substr(0, kPng.size()) == kPng) return read_png(bytes);
    if (bytes.substr(0, 2) == "P2" || bytes.substr(0, 2) == "P5") return PgmReader(bytes).read();
    const char* const kind = importers::kind_of(bytes);
    throw std::runtime_error(std::string("byte 0: found ") + (kind ? kind : "other bytes") +
                             ", expected a PNG picture, or P2 or P5, with which a PGM picture begins");
}

}  // namespace heightfield
