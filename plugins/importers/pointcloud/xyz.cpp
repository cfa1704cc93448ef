// Programs agree on x, y and z alone. PTS (Leica Cyclone) begins with the number of points and has x y z intensity r g b;
// MeshLab, CloudCompare and PDAL write x y z, x y z r g b or x y z nx ny nz, with blanks, commas or semicolons. So what stands
// behind z is judged by its first lines. Channels of 0 to 255 are sRGB, as scanners' cameras give them.
#include "xyz.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "../common/numbers.hpp"
#include "../openmesh/text.hpp"

namespace pointcloud {
namespace {

using namespace openmesh_import;

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

}  // namespace

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

}  // namespace pointcloud
