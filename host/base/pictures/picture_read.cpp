#include "base/pictures/picture_read.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <memory>

#include "base/error.hpp"
#include "base/files/read_file.hpp"
#include "base/pictures/srgb.hpp"

// Static, because importers hold the library too.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65536
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

#ifdef CLARITY_HAVE_OPENEXR
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#endif

namespace clarity {
namespace {

constexpr uint64_t kMaxBytes = uint64_t{4} << 30;
constexpr double kMaxPixels = 1e9;

FloatImage blank(double width, double height) {
    if (!(width >= 1 && height >= 1) || width * height > kMaxPixels)
        throw Error(Exit::failed, "its size is " + std::to_string(width) + " x " + std::to_string(height) +
                                      " pixels; a picture has 1 to 1e9");
    FloatImage image{static_cast<unsigned>(width), static_cast<unsigned>(height), 3, {}};
    image.pixels.resize(size_t(image.width) * image.height * 3);
    return image;
}

// Debevec's portable float map: "PF" or "Pf", width, height, scale (negative: little endian), one blank, then rows from the
// bottom.
struct PfmHead {
    int width = 0, height = 0, bytes = 0;
    char kind = 0;
    float scale = 0;
};
PfmHead read_pfm_head(const std::string& bytes) {
    PfmHead head;
    if (std::sscanf(bytes.c_str(), "P%c %d %d %f%n", &head.kind, &head.width, &head.height, &head.scale, &head.bytes) != 4 ||
        head.scale == 0 || (head.kind != 'F' && head.kind != 'f'))
        throw Error(Exit::failed, "its head is not that of a PFM: expected PF or Pf, width, height and scale");
    return head;
}
FloatImage read_pfm(const std::string& bytes) {
    const PfmHead head = read_pfm_head(bytes);
    FloatImage image = blank(head.width, head.height);
    const float scale = head.scale;
    const size_t channels = head.kind == 'F' ? 3 : 1, row = size_t(image.width) * channels,
                 first = static_cast<size_t>(head.bytes) + 1;
    if (bytes.size() < first + row * image.height * sizeof(float))
        throw Error(Exit::failed, "it is cut off: " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                                      " pixels need " + std::to_string(row * image.height * sizeof(float)) +
                                      " bytes behind the head");
    for (unsigned y = 0; y < image.height; ++y)
        for (size_t i = 0; i < size_t(image.width) * 3; ++i) {
            const size_t from = channels == 3 ? i : i / 3;
            uint32_t word;
            std::memcpy(&word, &bytes[first + ((image.height - 1 - y) * row + from) * sizeof(float)], sizeof word);
            if ((scale < 0) != (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)) word = __builtin_bswap32(word);
            std::memcpy(&image.pixels[size_t(y) * image.width * 3 + i], &word, sizeof word);
        }
    return image;
}

FloatImage read_png(const std::string& bytes) {
    int width = 0, height = 0, channels = 0;
    if (bytes.size() > INT_MAX) throw Error(Exit::failed, "it has more than 2 GiB");
    const std::unique_ptr<stbi_us, void (*)(void*)> values(
        stbi_load_16_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()), &width,
                                 &height, &channels, 3),
        stbi_image_free);
    if (!values) throw Error(Exit::failed, std::string("it is no PNG that can be read: ") + stbi_failure_reason());
    FloatImage image = blank(width, height);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = static_cast<float>(linear_from_srgb(values.get()[i] / 65535.0));
    }
    return image;
}

FloatImage read_hdr(const std::string& bytes) {
    int width = 0, height = 0, channels = 0;
    if (bytes.size() > INT_MAX) throw Error(Exit::failed, "it has more than 2 GiB");
    const std::unique_ptr<float, void (*)(void*)> values(
        stbi_loadf_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()), &width, &height,
                               &channels, 3),
        stbi_image_free);
    if (!values) throw Error(Exit::failed, std::string("it is no HDR that can be read: ") + stbi_failure_reason());
    FloatImage image = blank(width, height);
    std::memcpy(image.pixels.data(), values.get(), image.pixels.size() * sizeof(float));
    return image;
}

std::array<unsigned, 2> size_of_hdr(const std::string& bytes) {
    int width = 0, height = 0, channels = 0;
    if (bytes.size() > INT_MAX || !stbi_info_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                                                         static_cast<int>(bytes.size()), &width, &height, &channels))
        throw Error(Exit::failed, "its head is not that of an HDR");
    return {static_cast<unsigned>(width), static_cast<unsigned>(height)};
}

#ifdef CLARITY_HAVE_OPENEXR
// A file in memory. The library reads a few bytes at a time.
class ExrBytes : public Imf::IStream {
 public:
    explicit ExrBytes(const std::string& bytes) : Imf::IStream("the picture"), bytes_(bytes) {}
    bool read(char to[], int count) override {
        if (count < 0 || static_cast<size_t>(count) > bytes_.size() - at_) throw Error(Exit::failed, "it is cut off");
        std::memcpy(to, bytes_.data() + at_, static_cast<size_t>(count));
        at_ += static_cast<size_t>(count);
        return at_ < bytes_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t to) override {
        if (to > bytes_.size()) throw Error(Exit::failed, "it is cut off");
        at_ = to;
    }

 private:
    const std::string& bytes_;
    size_t at_ = 0;
};

double side(int first, int last) {
    return double(last) - first + 1;
}
std::array<unsigned, 2> size_of_exr(const std::string& bytes) {
    ExrBytes stream(bytes);
    const Imf::InputFile file(stream);
    const auto window = file.header().dataWindow();
    const auto limited = [](double size) { return static_cast<unsigned>(std::clamp(size, 0.0, 4e9)); };
    return {limited(side(window.min.x, window.max.x)), limited(side(window.min.y, window.max.y))};
}

FloatImage read_exr(const std::string& bytes) {
    ExrBytes stream(bytes);
    Imf::InputFile file(stream);
    const auto window = file.header().dataWindow();
    const Imf::ChannelList& channels = file.header().channels();
    const bool colors = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
    if (!colors && !channels.findChannel("Y")) throw Error(Exit::failed, "it has no channels R, G and B, and no Y");
    FloatImage image = blank(side(window.min.x, window.max.x), side(window.min.y, window.max.y));
    Imf::FrameBuffer frame;
    const size_t pixel = 3 * sizeof(float), row = pixel * image.width;
    // The library counts from the origin of the data window.
    char* const base =
        reinterpret_cast<char*>(image.pixels.data()) - window.min.x * ptrdiff_t(pixel) - window.min.y * ptrdiff_t(row);
    const char* const names[] = {colors ? "R" : "Y", "G", "B"};
    for (size_t c = 0; c < (colors ? 3 : 1); ++c)
        frame.insert(names[c], Imf::Slice(Imf::FLOAT, base + c * sizeof(float), pixel, row));
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    if (!colors)
        for (size_t i = 0; i < image.pixels.size(); i += 3) image.pixels[i + 1] = image.pixels[i + 2] = image.pixels[i];
    return image;
}
#else
FloatImage read_exr(const std::string&) {
    throw Error(Exit::failed, "this build cannot read EXR: OpenEXR was missing when it was configured");
}
std::array<unsigned, 2> size_of_exr(const std::string& bytes) {
    const FloatImage image = read_exr(bytes);
    return {image.width, image.height};
}
#endif

enum class Format { other, png, exr, pfm, hdr };
Format format_of(const std::string& bytes) {
    const auto begins = [&](const char* text, size_t size) { return bytes.compare(0, size, text, size) == 0; };
    if (begins("\x89PNG", 4)) return Format::png;
    if (begins("\x76\x2f\x31\x01", 4)) return Format::exr;
    if (begins("PF", 2) || begins("Pf", 2)) return Format::pfm;
    return begins("#?", 2) ? Format::hdr : Format::other;
}

}  // namespace

FloatImage decode_picture(const std::string& bytes) {
    switch (format_of(bytes)) {
        case Format::png:
            return read_png(bytes);
        case Format::exr:
            return read_exr(bytes);
        case Format::pfm:
            return read_pfm(bytes);
        case Format::hdr:
            return read_hdr(bytes);
        case Format::other:
            break;
    }
    throw Error(Exit::failed, "it is none of PNG, EXR, HDR and PFM");
}

FloatImage read_picture(const std::string& path) {
    const std::string bytes = read_file(path, kMaxBytes, Exit::failed);
    try {
        return decode_picture(bytes);
    } catch (const std::exception& e) {
        throw Error(Exit::failed, path + ": the picture cannot be read: " + e.what());
    }
}

bool holds_floats(const std::string& bytes) {
    const Format format = format_of(bytes);
    return format == Format::exr || format == Format::pfm || format == Format::hdr;
}

std::array<unsigned, 2> size_of_floats(const std::string& bytes) {
    const Format format = format_of(bytes);
    if (format == Format::exr) return size_of_exr(bytes);
    if (format == Format::hdr) return size_of_hdr(bytes);
    const PfmHead head = read_pfm_head(bytes);
    return {static_cast<unsigned>(std::max(head.width, 0)), static_cast<unsigned>(std::max(head.height, 0))};
}

}  // namespace clarity
