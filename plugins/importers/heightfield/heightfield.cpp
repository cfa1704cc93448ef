// heightfield.cpp -- the importer plugin for height maps: pictures whose brightness is the height of a terrain.
//
// Samples lie in the x z plane, y is up. The top of the picture is farthest along -z, so that seen from +z and above the
// terrain lies as the picture does. A cell between four samples becomes two triangles, cut along the diagonal whose ends differ
// less, which keeps ridges. Normals are those of the surface through the neighbours (central differences).
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65536
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cctype>
#include <climits>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "../common/file_kind.hpp"
#include "../common/mapped_file.hpp"
#include "../common/mesh_arrays.hpp"
#include "../common/numbers.hpp"
#include "../common/texture_path.hpp"
#include "rt_plugin.h"
#include "rt_plugin.hpp"

namespace heightfield {
namespace {

// The samples of a height map: PNG of 8 and 16 bits, PGM as text and binary.
struct Picture {
    rt_u32 width = 0, height = 0;
    std::vector<float> samples;  // shares of the largest value that the file can hold, row by row from the top
    std::string left_out;        // what the file has besides; empty: nothing
};

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

// Reads the file by its first bytes. Throws std::runtime_error with the reason (without the file's name).
Picture read_picture(std::string_view bytes) {
    if (bytes.substr(0, kPng.size()) == kPng) return read_png(bytes);
    if (bytes.substr(0, 2) == "P2" || bytes.substr(0, 2) == "P5") return PgmReader(bytes).read();
    const char* const kind = importers::kind_of(bytes);
    throw std::runtime_error(std::string("byte 0: found ") + (kind ? kind : "other bytes") +
                             ", expected a PNG picture, or P2 or P5, with which a PGM picture begins");
}

enum Param { kWidth, kHeight, kStep };
constexpr rt_param kParams[] = {
    rt::float_param("width", "Width", "extent along x, in scene units; 0: one unit a sample", 0, 1e9, 0),
    rt::float_param("height", "Height",
                    "what the brightest value is above the darkest, in scene units; 0: an eighth of the longer side", 0, 1e9,
                    0),
    rt::int_param("step", "Step", "takes every n-th sample along both sides", 1, 1024, 1),
};

class Terrain {
 public:
    Terrain(const Picture& picture, const double* params)
        : picture_(picture),
          step_(static_cast<rt_u32>(params[kStep])),
          columns_((picture.width - 1) / step_ + 1),
          rows_((picture.height - 1) / step_ + 1),
          spacing_(params[kWidth] > 0 ? params[kWidth] / double(picture.width - 1) * step_ : step_),
          relief_(params[kHeight] > 0 ? params[kHeight] : double(std::max(columns_, rows_) - 1) * spacing_ / 8) {
        if (columns_ < 2 || rows_ < 2)
            throw std::runtime_error("takes " + std::to_string(columns_) + " x " + std::to_string(rows_) + " of " +
                                     std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                                     " samples, expected 2 x 2 or more: a terrain has an area");
    }

    void mesh(importers::MeshArrays& mesh, std::vector<rt_u32>& corners) const {
        const size_t count = size_t(columns_) * rows_;
        mesh.positions.reserve(3 * count);
        mesh.normals.reserve(3 * count);
        mesh.uvs.reserve(2 * count);
        corners.reserve(6 * size_t(columns_ - 1) * (rows_ - 1));
        for (rt_u32 j = 0; j < rows_; ++j)
            for (rt_u32 i = 0; i < columns_; ++i) vertex(i, j, mesh);
        for (rt_u32 j = 0; j + 1 < rows_; ++j)
            for (rt_u32 i = 0; i + 1 < columns_; ++i) cell(i, j, corners);
    }

 private:
    double height(rt_u32 i, rt_u32 j) const {
        return relief_ * double(picture_.samples[size_t(j) * step_ * picture_.width + size_t(i) * step_]);
    }
    void vertex(rt_u32 i, rt_u32 j, importers::MeshArrays& mesh) const {
        const double x = (i - (columns_ - 1) / 2.0) * spacing_, z = (j - (rows_ - 1) / 2.0) * spacing_;
        for (const double p : {x, height(i, j), z}) mesh.positions.push_back(static_cast<float>(p));
        const rt_u32 left = i > 0 ? i - 1 : 0, right = std::min(i + 1, columns_ - 1);
        const rt_u32 back = j > 0 ? j - 1 : 0, front = std::min(j + 1, rows_ - 1);
        const double along_x = (height(right, j) - height(left, j)) / ((right - left) * spacing_);
        const double along_z = (height(i, front) - height(i, back)) / ((front - back) * spacing_);
        const double length = std::sqrt(along_x * along_x + along_z * along_z + 1);
        for (const double n : {-along_x, 1.0, -along_z}) mesh.normals.push_back(static_cast<float>(n / length));
        mesh.uvs.push_back(static_cast<float>(double(i) * step_ / (picture_.width - 1)));
        mesh.uvs.push_back(static_cast<float>(1 - double(j) * step_ / (picture_.height - 1)));
    }
    void cell(rt_u32 i, rt_u32 j, std::vector<rt_u32>& corners) const {
        const rt_u32 a = j * columns_ + i, b = a + 1, c = a + columns_, d = c + 1;  // a b behind, c d in front
        const bool along_a_d = std::fabs(height(i, j) - height(i + 1, j + 1)) <= std::fabs(height(i + 1, j) - height(i, j + 1));
        if (along_a_d)
            corners.insert(corners.end(), {a, c, d, a, d, b});
        else
            corners.insert(corners.end(), {a, c, b, b, c, d});
    }

    const Picture& picture_;
    rt_u32 step_, columns_, rows_;
    double spacing_, relief_;
};

int32_t load(const rt_host* host, const char* path, const double* params, const rt_scene_sink* sink) {
    const importers::MappedFile file(host, path);
    if (file.bytes().empty()) throw std::runtime_error("the file is empty");
    importers::MeshArrays mesh;
    std::vector<rt_u32> corners;
    {
        const Picture picture = read_picture(file.bytes());
        if (!picture.left_out.empty()) rt::warn(*sink, picture.left_out);
        rt::progress(host, 0.4f);
        Terrain(picture, params).mesh(mesh, corners);
    }
    rt::progress(host, 0.7f);
    const rt_scene_info info{sizeof info, 1, 0, nullptr, nullptr};
    sink->info(sink->ctx, &info);
    const std::string name = importers::FilePlace(path).stem;
    const rt_instance_desc instance =
        rt::instance(mesh.pass(name, corners.data(), corners.size(), {RT_NONE}, *sink), name.c_str());
    rt::id(sink->instance(sink->ctx, &instance));
    return RT_OK;
}

int32_t probe(const uint8_t* head, uint64_t bytes) {
    const std::string_view text(reinterpret_cast<const char*>(head), bytes);
    if (text.substr(0, 4) == "\x89PNG") return 60;
    return text.size() > 2 && (text.substr(0, 2) == "P5" || text.substr(0, 2) == "P2") && std::isspace(head[2]) ? 60 : 0;
}

constexpr const char* kExtensions[] = {"png", "pgm", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>, RT_IMPORTER_TAKES_CONTENT, 0};

}  // namespace
}  // namespace heightfield

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 = rt::importer_plugin("heightfield", "Height maps (PNG, PGM)", "1.0.0",
                                                                        nullptr, heightfield::kParams, heightfield::kImporter);
