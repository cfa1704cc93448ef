// Libraries encode PNG (stb) and EXR (OpenEXR). PFM is a header followed by the floats.
#include "base/pictures/image_io.hpp"

// Static, because the window links the stb library too.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

#ifdef CLARITY_HAVE_OPENEXR
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#endif

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/timeline.hpp"

namespace clarity {
namespace {

// Texts in PNG files: chunks tEXt, and iTXt for texts beyond ASCII (PNG specification, third edition, 11.3.3).

// Signature, and the chunk IHDR, which is always the first: length, name, 13 bytes, checksum.
constexpr size_t kBehindHeader = 8 + 4 + 4 + 13 + 4;

std::string big_endian(uint32_t value) {
    return {char(value >> 24), char(value >> 16), char(value >> 8), char(value)};
}

std::string chunk(const std::string& name, const std::string& data) {
    const std::string checked = name + data;
    const auto sum = crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size()));
    return big_endian(static_cast<uint32_t>(data.size())) + checked + big_endian(static_cast<uint32_t>(sum));
}

// Puts texts into an encoded PNG, before its pixels. Keys: 1 to 79 letters, digits or spaces. Values: UTF-8.
void add_png_texts(std::string& png, const std::vector<std::pair<std::string, std::string>>& texts) {
    std::string chunks;
    for (const auto& [key, value] : texts) {
        const bool ascii = std::all_of(value.begin(), value.end(), [](char c) { return c >= ' ' && c <= '~'; });
        // iTXt: no compression, no language, no translated key.
        chunks += ascii ? chunk("tEXt", key + '\0' + value) : chunk("iTXt", key + std::string(5, '\0') + value);
    }
    if (png.size() > kBehindHeader) png.insert(kBehindHeader, chunks);
}

enum class Ending { png, exr, pfm, other };

Ending ending_of(const std::string& path) {
    const size_t dot = path.rfind('.'), slash = path.rfind('/');
    if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return Ending::other;
    std::string ending = path.substr(dot + 1);
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return ending == "png" ? Ending::png : ending == "exr" ? Ending::exr : ending == "pfm" ? Ending::pfm : Ending::other;
}

void check_ending(const std::string& path) {
    const Ending ending = ending_of(path);
    if (ending == Ending::other)
        throw Error(Exit::usage, "`" + path + "`: its ending is not a picture format; use .png, .exr or .pfm");
#ifndef CLARITY_HAVE_OPENEXR
    if (ending == Ending::exr)
        throw Error(Exit::usage, "`" + path +
                                     "`: this build cannot write EXR: OpenEXR was missing when it was configured; "
                                     "install libopenexr-dev and build again, or write .pfm");
#endif
}

// Checks the caller's image, so that a wrong size does not become a read beyond its end.
void check_size(const std::string& path, unsigned width, unsigned height, unsigned channels, size_t found) {
    const size_t expected = size_t(width) * height * channels;
    if (expected == 0 || found != expected)
        throw Error(Exit::failed, path + ": not written: a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                                      " pixels with " + std::to_string(channels) + " channels has " + std::to_string(expected) +
                                      " values, but " + std::to_string(found) + " were given");
}

void write_whole(const std::string& path, const std::string& bytes, const PictureNotes& notes) {
    OutputFile file(path);
    file.write(bytes.data(), bytes.size());
    if (notes.sync) file.sync();
    file.commit();
}

void write_png(const std::string& path, const ByteImage& image, const PictureNotes& notes) {
    check_size(path, image.width, image.height, 4, image.pixels.size());
    const size_t pixels = size_t(image.width) * image.height;
    if (pixels > kPngMaxPixels)
        throw Error(Exit::failed, path + ": not written: the PNG encoder cannot write more than " +
                                      std::to_string(kPngMaxPixels) + " pixels; write .exr or .pfm");
    bool opaque = true;
    for (size_t i = 0; i < pixels && opaque; ++i) opaque = image.pixels[4 * i + 3] == 255;
    const int channels = opaque ? 3 : 4;
    std::vector<uint8_t> packed;
    if (opaque) {
        packed.resize(3 * pixels);
        for (size_t i = 0; i < pixels; ++i) std::memcpy(&packed[3 * i], &image.pixels[4 * i], 3);
    }
    struct Sink {
        std::string bytes;
        bool failed = false;  // an exception must not pass through the C library
    } sink;
    const auto append = [](void* context, void* data, int bytes) {
        Sink& to = *static_cast<Sink*>(context);
        try {
            to.bytes.append(static_cast<const char*>(data), static_cast<size_t>(bytes));
        } catch (...) {
            to.failed = true;
        }
    };
    const int done =
        stbi_write_png_to_func(append, &sink, static_cast<int>(image.width), static_cast<int>(image.height), channels,
                               opaque ? packed.data() : image.pixels.data(), static_cast<int>(image.width) * channels);
    if (!done || sink.failed) throw Error(Exit::failed, path + ": not written: the PNG encoder ran out of memory");
    add_png_texts(sink.bytes, notes.texts);
    write_whole(path, sink.bytes, notes);
}

void write_pfm(const std::string& path, const FloatImage& image, const PictureNotes& notes) {
    if (image.channels != 1 && image.channels != 3)
        throw Error(Exit::failed,
                    path + ": not written: PFM holds 1 or 3 channels, this picture has " + std::to_string(image.channels));
    OutputFile file(path);
    // A negative scale means little endian.
    const std::string head = std::string(image.channels == 3 ? "PF" : "Pf") + "\n" + std::to_string(image.width) + " " +
                             std::to_string(image.height) + "\n-1.0\n";
    file.write(head.data(), head.size());
    const size_t row = size_t(image.width) * image.channels;
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
    std::vector<uint32_t> swapped(row);
#endif
    for (unsigned y = image.height; y-- > 0;) {
        const float* values = &image.pixels[y * row];
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
        std::memcpy(swapped.data(), values, row * sizeof(float));
        for (uint32_t& value : swapped) value = __builtin_bswap32(value);
        file.write(swapped.data(), row * sizeof(float));
#else
        file.write(values, row * sizeof(float));
#endif
    }
    if (notes.sync) file.sync();
    file.commit();
}

#ifdef CLARITY_HAVE_OPENEXR
// Collects the file in memory. We then write it as every other format, so that a full disk is reported in the same way.
class ExrStream : public Imf::OStream {
 public:
    ExrStream(const std::string& name, std::string& bytes) : Imf::OStream(name.c_str()), bytes_(bytes) {}
    void write(const char data[], int count) override {
        const size_t end = at_ + static_cast<size_t>(count);
        if (end > bytes_.size()) bytes_.resize(end);
        std::memcpy(&bytes_[at_], data, static_cast<size_t>(count));
        at_ = end;
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t position) override { at_ = position; }

 private:
    std::string& bytes_;
    uint64_t at_ = 0;
};

std::string encode_exr(const std::string& path, const std::vector<PictureLayer>& layers, const PictureNotes& notes) {
    const FloatImage& first = layers.front().values;
    Imf::Header header(static_cast<int>(first.width), static_cast<int>(first.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [key, value] : notes.texts) header.insert(key, Imf::StringAttribute(value));
    Imf::FrameBuffer frame;
    for (const PictureLayer& layer : layers) {
        const FloatImage& image = layer.values;
        const char* names = image.channels == 1 ? "Y" : layer.name.empty() ? "RGB" : "XYZ";
        // The library's slices are not const, but an output file only reads them.
        char* base = reinterpret_cast<char*>(const_cast<float*>(image.pixels.data()));
        const size_t pixel_bytes = image.channels * sizeof(float);
        for (size_t c = 0; names[c]; ++c) {
            const std::string name = (layer.name.empty() ? "" : layer.name + ".") + names[c];
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            frame.insert(name, Imf::Slice(Imf::FLOAT, base + c * sizeof(float), pixel_bytes, pixel_bytes * image.width));
        }
    }
    std::string bytes;
    ExrStream stream(path, bytes);
    {
        Imf::OutputFile file(stream, header);  // its destructor writes the line table
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(first.height));
    }
    return bytes;
}

void write_exr(const std::string& path, const std::vector<PictureLayer>& layers, const PictureNotes& notes) {
    for (const PictureLayer& layer : layers)
        if (layer.values.channels != 1 && layer.values.channels != 3)
            throw Error(Exit::failed, path + ": not written: 1 or 3 channels are supported, this picture has " +
                                          std::to_string(layer.values.channels));
    std::string bytes;
    try {
        bytes = encode_exr(path, layers, notes);
    } catch (const std::exception& e) {
        throw Error(Exit::failed, path + ": not written: OpenEXR says: " + e.what());
    }
    write_whole(path, bytes, notes);
}
#else
void write_exr(const std::string& path, const std::vector<PictureLayer>&, const PictureNotes&) {
    check_ending(path);
}
#endif

}  // namespace

PictureNotes picture_notes(bool denoised) {
    PictureNotes notes{{{"Software", std::string("clarity ") + CLARITY_VERSION}}, false};
    if (denoised) notes.texts.emplace_back("Denoised", "noise is filtered away, which biases the picture");
    return notes;
}

void write_image(const std::string& path, const FloatImage& values, const ByteImage& display, const PictureNotes& notes) {
    const timeline::Scope span("write", [&] { return "write " + path; });
    const PendingWrite pending;
    check_ending(path);
    const Ending ending = ending_of(path);
    if (ending == Ending::png) return write_png(path, display, notes);
    check_size(path, values.width, values.height, values.channels, values.pixels.size());
    return ending == Ending::exr ? write_exr(path, {{"", values}}, notes) : write_pfm(path, values, notes);
}

void write_layers(const std::string& path, const std::vector<PictureLayer>& layers, const PictureNotes& notes) {
    const PendingWrite pending;
    check_ending(path);
    for (const PictureLayer& layer : layers)
        check_size(path, layers.front().values.width, layers.front().values.height, layer.values.channels,
                   layer.values.pixels.size());
    write_exr(path, layers, notes);
}

bool holds_layers(const std::string& path) {
    return ending_of(path) == Ending::exr;
}

bool writes_display(const std::string& path) {
    return ending_of(path) == Ending::png;
}

void check_output_path(const std::string& path) {
    check_ending(path);
    check_writable(path);
}

}  // namespace clarity
