#include "base/pictures/picture_read.hpp"

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
FloatImage read_pfm(const std::string& bytes) {
    int width = 0, height = 0, head = 0;
    char kind = 0;
    float scale = 0;
    if (std::sscanf(bytes.c_str(), "P%c %d %d %f%n", &kind, &width, &height, &scale, &head) != 4 || scale == 0 ||
        (kind != 'F' && kind != 'f'))
        throw Error(Exit::failed, "its head is not that of a PFM: expected PF or Pf, width, height and scale");
    FloatImage image = blank(width, height);
    const size_t channels = kind == 'F' ? 3 : 1, row = size_t(image.width) * channels, first = static_cast<size_t>(head) + 1;
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

#ifdef CLARITY_HAVE_OPENEXR
FloatImage read_exr(const std::string& path) {
    Imf::InputFile file(path.c_str());
    const auto window = file.header().dataWindow();
    const Imf::ChannelList& channels = file.header().channels();
    const bool colors = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
    if (!colors && !channels.findChannel("Y")) throw Error(Exit::failed, "it has no channels R, G and B, and no Y");
    FloatImage image = blank(double(window.max.x) - window.min.x + 1, double(window.max.y) - window.min.y + 1);
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
#endif

}  // namespace

FloatImage read_picture(const std::string& path) {
    const std::string bytes = read_file(path, kMaxBytes, Exit::failed);
    try {
        if (bytes.compare(0, 4, "\x89PNG") == 0) return read_png(bytes);
        if (bytes.compare(0, 4, "\x76\x2f\x31\x01") == 0) return read_exr(path);
        if (bytes.compare(0, 2, "PF") == 0 || bytes.compare(0, 2, "Pf") == 0) return read_pfm(bytes);
        if (bytes.compare(0, 2, "#?") == 0) return read_hdr(bytes);
        throw Error(Exit::failed, "it is none of PNG, EXR, HDR and PFM");
    } catch (const std::exception& e) {
        throw Error(Exit::failed, path + ": the picture cannot be read: " + e.what());
    }
}

}  // namespace clarity
