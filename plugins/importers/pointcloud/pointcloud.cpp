// pointcloud.cpp -- the importer plugin for points: PLY without faces, XYZ, PTS and ASC. Each point is a sphere.
//
// Spheres have materials, not colours of their own, so each colour is a material. Spheres have no origin of their
// own either: where points are far from 0, they are moved there, and a warning says by how much.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <vector>

#include "../common/file_kind.hpp"
#include "../common/mapped_file.hpp"
#include "../common/mesh_arrays.hpp"
#include "../common/numbers.hpp"
#include "../openmesh/ply_header.hpp"
#include "../openmesh/readers.hpp"
#include "../openmesh/text.hpp"
#include "rt_plugin.h"
#include "rt_plugin.hpp"

namespace pointcloud {
namespace {

using namespace openmesh_import;

// Reads points as text: a line for each with x, y, z, and perhaps an intensity, a colour, a normal.
// Programs agree on x, y and z alone. PTS (Leica Cyclone) begins with the number of points and has x y z intensity r g b;
// MeshLab, CloudCompare and PDAL write x y z, x y z r g b or x y z nx ny nz, with blanks, commas or semicolons. So what stands
// behind z is judged by its first lines. Channels of 0 to 255 are sRGB, as scanners' cameras give them.

constexpr size_t kMostColumns = 16;

// The numbers of a line. Returns how many there are, at most kMostColumns; a word that is none ends them.
size_t numbers_of(std::string_view line, double (&numbers)[kMostColumns], std::string_view& odd) {
    const auto is_between = [](char c) { return is_blank(c) || c == ',' || c == ';'; };
    size_t count = 0;
    odd = {};
    for (size_t at = 0; at < line.size() && count < kMostColumns;) {
        while (at < line.size() && is_between(line[at])) ++at;
        size_t end = at;
        while (end < line.size() && !is_between(line[end])) ++end;
        if (end == at) break;
        const std::string_view word = line.substr(at, end - at);
        if (!parse_float(word, numbers[count])) {
            if (!is_odd_number(word)) {
                odd = word;
                break;
            }
            numbers[count] = NAN;
        }
        ++count;
        at = end;
    }
    return count;
}

bool is_comment(std::string_view line) {
    return line.empty() || line[0] == '#' || line.substr(0, 2) == "//";
}

// In which column colours begin, if lines have some.
class Columns {
 public:
    explicit Columns(std::string_view text) {
        constexpr int kLines = 1000;
        Lines lines(text);
        std::string_view odd;
        double numbers[kMostColumns];
        bool bytes = true, beyond_one = false;
        for (std::string_view line; seen_ < kLines && lines.next(line);) {
            const size_t count = is_comment(trim(line)) ? 0 : numbers_of(line, numbers, odd);
            if (count < 3) continue;
            columns_ = seen_++ == 0 ? count : std::min(count, columns_);
            widest_ = std::max(count, widest_);
            const size_t first = first_of(columns_);
            for (size_t k = first; k < first + 3 && k < columns_; ++k) {
                bytes = bytes && numbers[k] >= 0 && numbers[k] <= 255 && numbers[k] == std::floor(numbers[k]);
                beyond_one = beyond_one || numbers[k] > 1;
            }
        }
        if (columns_ >= 6 && bytes && beyond_one) color_ = first_of(columns_);
    }
    std::optional<size_t> color() const { return color_; }
    bool leaves_out() const { return widest_ > (color_ ? 6u : 3u); }

 private:
    static size_t first_of(size_t columns) { return columns == 7 ? 4 : 3; }
    size_t columns_ = 0, widest_ = 0;  // of the shortest line, and of the longest
    int seen_ = 0;
    std::optional<size_t> color_;
};

// Adds a vertex for each point, with a colour if lines have one. Throws std::runtime_error with line and reason.
void read_xyz(const Source& source, FlatMesh& mesh) {
    const Columns columns(source.bytes);
    if (columns.leaves_out())
        warn(source, columns.color() ? "takes x, y, z and the colour of each line; other numbers are left out"
                                     : "takes x, y and z of each line; other numbers are left out");
    const size_t needed = columns.color() ? *columns.color() + 3 : 3;
    Lines lines(source.bytes);
    Steps steps(source);
    std::string_view odd;
    double numbers[kMostColumns];
    bool is_first = true;
    for (std::string_view line; lines.next(line);) {
        line = trim(line);
        if (is_comment(line)) continue;
        const size_t count = numbers_of(line, numbers, odd);
        // A line of names, or the number of points of PTS.
        const bool is_head = is_first && (count == 0 || (count == 1 && odd.empty()));
        is_first = false;
        if (is_head) continue;
        const std::string where = count >= needed ? "" : "line " + std::to_string(lines.number()) + ": ";
        if (count < needed)
            throw std::runtime_error(where + "found " + (odd.empty() ? counted(count, "number") : quoted(odd)) + ", expected " +
                                     std::to_string(needed) + " numbers of a point");
        mesh.add_vertex(numbers[0], numbers[1], numbers[2]);
        if (columns.color()) {
            for (size_t k = 0; k < 3; ++k)
                mesh.colors.push_back(importers::linear_of_srgb(numbers[*columns.color() + k] / 255));
            mesh.colors.push_back(1);
        }
        steps.step([&] { return lines.fraction(); });
    }
}

// What turns points into spheres: a radius that fits their spacing, and a material for each colour.

// Colours with the points that have them.
struct Palette {
    std::vector<float> colors;  // linear r, g, b of each
    std::vector<rt_u32> of_point;
    size_t different = 0;  // colours of 8 bits a channel that the points have
};

// Every third bit is one of x's.
uint64_t spread(uint64_t x) {
    x &= 0x1FFFFF;
    x = (x | x << 32) & 0x1F00000000FFFF;
    x = (x | x << 16) & 0x1F0000FF0000FF;
    x = (x | x << 8) & 0x100F00F00F00F00F;
    x = (x | x << 4) & 0x10C30C30C30C30C3;
    return (x | x << 2) & 0x1249249249249249;
}

rt_u32 byte_of(float linear) {
    const double x = std::clamp(double(linear), 0.0, 1.0);
    return static_cast<rt_u32>(std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

// The median distance of points to their nearest neighbour; points at one place do not count. 0: no two places differ.
// positions: three numbers a point.
double spacing(const std::vector<float>& positions) {
    const size_t count = positions.size() / 3;
    const importers::Box box(positions);
    if (count < 2 || !(box.size() > 0)) return 0;
    // Along a Morton curve most neighbours are near in the list. Too large a distance where they are not moves the median
    // little.
    constexpr size_t kSamples = 4096, kWindow = 48;
    std::vector<std::pair<uint64_t, size_t>> order(count);
    for (size_t i = 0; i < count; ++i) {
        uint64_t code = 0;
        for (size_t k = 0; k < 3; ++k)
            code |= spread(static_cast<uint64_t>((double(positions[3 * i + k]) - box.lo[k]) / box.size() * 0x1FFFFF)) << k;
        order[i] = {code, i};
    }
    std::sort(order.begin(), order.end());
    std::vector<double> distances;
    for (size_t s = 0, samples = std::min(count, kSamples); s < samples; ++s) {
        const size_t at = s * count / samples;
        double nearest = HUGE_VAL;
        for (size_t j = at - std::min(at, kWindow), end = std::min(count, at + kWindow + 1); j < end; ++j) {
            double square = 0;
            for (size_t k = 0; k < 3; ++k) {
                const double d = double(positions[3 * order[j].second + k]) - double(positions[3 * order[at].second + k]);
                square += d * d;
            }
            if (square > 0) nearest = std::min(nearest, square);
        }
        if (nearest < HUGE_VAL) distances.push_back(std::sqrt(nearest));
    }
    if (distances.empty()) return 0;
    const auto middle = distances.begin() + static_cast<ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

// At most 2^15 colours: where points have more, bits of channels are dropped, and a group of colours has its mean.
// colors: linear r, g, b, and alpha a point.
Palette palette_of(const std::vector<float>& colors) {
    constexpr size_t kMost = 1u << 15;
    const size_t count = colors.size() / 4;
    std::vector<rt_u32> keys(count);
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < 3; ++k) keys[i] = keys[i] << 8 | byte_of(colors[4 * i + k]);
    Palette palette;
    std::vector<rt_u32> different;
    for (rt_u32 drop = 0;; ++drop) {
        const rt_u32 channel = 0xFFu >> drop << drop, mask = channel << 16 | channel << 8 | channel;
        for (rt_u32& key : keys) key &= mask;
        different = keys;
        std::sort(different.begin(), different.end());
        different.erase(std::unique(different.begin(), different.end()), different.end());
        if (drop == 0) palette.different = different.size();
        if (different.size() <= kMost) break;
    }
    std::vector<double> sums(4 * different.size());
    for (size_t i = 0; i < count; ++i) {
        const auto at = std::lower_bound(different.begin(), different.end(), keys[i]) - different.begin();
        palette.of_point.push_back(static_cast<rt_u32>(at));
        for (size_t k = 0; k < 3; ++k) sums[4 * size_t(at) + k] += double(colors[4 * i + k]);
        ++sums[4 * size_t(at) + 3];
    }
    for (size_t i = 0; i < sums.size(); i += 4)
        for (size_t k = 0; k < 3; ++k) palette.colors.push_back(static_cast<float>(sums[i + k] / sums[i + 3]));
    return palette;
}

enum Param { kRadius };
constexpr rt_param kParams[] = {
    rt::float_param("radius", "Radius", "of each point, in scene units; 0: seven tenths of the median distance of neighbours",
                    0, 1e9, 0),
};

// Half of a square's diagonal: spheres of a square lattice then leave no hole.
constexpr double kRadiusPerSpacing = 0.7072;
// Of the progress; the rest is the host's copy.
constexpr float kReadShare = 0.7f;

// The materials of the points; one for all if they have no colours.
std::vector<rt_u32> materials_of(const Source& source, const FlatMesh& mesh) {
    const size_t count = mesh.vertex_count();
    if (mesh.colors.size() != 4 * count) return std::vector<rt_u32>(count, RT_NONE);
    const Palette palette = palette_of(mesh.colors);
    if (palette.different * 3 > palette.colors.size())
        warn(source, "has " + std::to_string(palette.different) + " colours; those that are alike are drawn as one of " +
                         std::to_string(palette.colors.size() / 3));
    std::vector<rt_u32> ids;
    for (size_t i = 0; i < palette.colors.size(); i += 3) {
        rt_material_desc material = rt::material();
        std::copy_n(&palette.colors[i], 3, material.color);
        ids.push_back(rt::id(source.sink.material(source.sink.ctx, &material)));
    }
    std::vector<rt_u32> materials;
    for (const rt_u32 color : palette.of_point) materials.push_back(ids[color]);
    return materials;
}

void emit(const rt_host* host, const Source& source, const FlatMesh& mesh, double radius) {
    if (std::any_of(mesh.origin, mesh.origin + 3, [](double x) { return x != 0; })) {
        char text[160];
        std::snprintf(text, sizeof text,
                      "its points are moved by %.17g %.17g %.17g to the origin, since floats would lose their digits",
                      0 - mesh.origin[0], 0 - mesh.origin[1], 0 - mesh.origin[2]);
        warn(source, text);
    }
    const std::vector<rt_u32> materials = materials_of(source, mesh);
    for (size_t i = 0; i < mesh.corners.size(); ++i) {
        const rt_u32 point = mesh.corners[i];
        rt::id(source.sink.sphere(source.sink.ctx, &mesh.positions[3 * size_t(point)], static_cast<float>(radius),
                                  materials[point]));
        if (i % 65536 == 0)
            rt::progress(host, kReadShare + (1 - kReadShare) * static_cast<float>(i) / static_cast<float>(mesh.corners.size()));
    }
}

int32_t load(const rt_host* host, const char* path, const double* params, const rt_scene_sink* sink) {
    const importers::MappedFile file(host, path);
    if (file.bytes().empty()) throw std::runtime_error("the file is empty");
    const bool of_ply = ply::is_ply(file.bytes());
    const char* kind = importers::kind_of(file.bytes());
    if (kind && !of_ply) throw std::runtime_error(std::string("byte 0: found ") + kind + ", expected points as text");
    const auto report = [&](float fraction) { rt::progress(host, kReadShare * std::clamp(fraction, 0.0f, 1.0f)); };
    const Source source{path, file.bytes(), report, *sink};
    FlatMesh mesh;
    if (of_ply)
        read_ply_points(source, mesh);
    else
        read_xyz(source, mesh);
    // A face of one corner for each point: finish() leaves out those that are not finite.
    for (size_t i = 0, count = mesh.vertex_count(); i < count; ++i) {
        mesh.corners.push_back(static_cast<rt_u32>(i));
        mesh.add_face(1);
    }
    mesh.finish();
    if (mesh.broken_faces > 0)
        warn(source, counted(mesh.broken_faces, "point") + " left out because of coordinates that are not finite");
    if (mesh.corners.empty()) throw std::runtime_error("contains no points");
    const double radius = params[kRadius] > 0 ? params[kRadius] : kRadiusPerSpacing * spacing(mesh.positions);
    emit(host, source, mesh, radius > 0 ? radius : 1);
    return RT_OK;
}

// Sure of a PLY header that names vertices and no faces.
int32_t probe(const uint8_t* head, uint64_t bytes) {
    const std::string_view text(reinterpret_cast<const char*>(head), bytes);
    const std::string_view header = text.substr(0, text.find("end_header"));
    if (!ply::is_ply(text) || header.size() == text.size()) return 0;
    const auto has = [&](const char* element) { return header.find(element) != header.npos; };
    return has("element vertex ") && !has("element face ") && !has("element tristrips ") ? 100 : 0;
}

constexpr const char* kExtensions[] = {"ply", "xyz", "pts", "asc", nullptr};
constexpr rt_importer kImporter = {sizeof(rt_importer), kExtensions, probe, rt::guarded<load>, RT_IMPORTER_TAKES_CONTENT, 0};

}  // namespace
}  // namespace pointcloud

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 = rt::importer_plugin("pointcloud", "Point clouds (PLY, XYZ, PTS)", "1.0.0",
                                                                        nullptr, pointcloud::kParams, pointcloud::kImporter);
