#include "stand/ray_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "base/files/read_file.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "tracers/rays/ray_query.hpp"

namespace clarity {
namespace {

constexpr uint64_t kMaxRayFileBytes = uint64_t{4} << 30;
constexpr const char* kFields[RT_RAY_FIELDS] = {"origin x",    "origin y",    "origin z",    "t_min",
                                                "direction x", "direction y", "direction z", "t_max"};
constexpr const char* kForm = "a ray is eight numbers: origin x y z, t_min, direction x y z, t_max";

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == ',' || c == '\r';
}

// One line of the file.
class Line {
 public:
    Line(std::string_view text, const std::string& file, size_t number) : text_(text), file_(file), number_(number) {}
    // Returns whether the line has a ray.
    bool read(rt_ray& ray, std::array<double, 3>& origin) {
        float fields[RT_RAY_FIELDS];
        size_t count = 0;
        for (std::string_view word = next(); !word.empty(); word = next()) {
            if (count == RT_RAY_FIELDS) fail("a ninth number '" + shown(word) + "' on the line; " + kForm);
            const char* const begin = word.data() + (word.size() > 1 && word[0] == '+');
            const auto [end, error] = std::from_chars(begin, word.data() + word.size(), fields[count]);
            if (error == std::errc::result_out_of_range)
                fail("'" + shown(word) + "' is beyond the range of a float: write inf or 0 (" + kFields[count] + ")");
            if (error != std::errc() || end != word.data() + word.size())
                fail("found '" + shown(word) + "', expected a number (" + kFields[count] + "); " + kForm);
            if (count < 3 && std::from_chars(begin, end, origin[count]).ec != std::errc()) origin[count] = fields[count];
            ++count;
        }
        if (count == 0) return false;
        if (count < RT_RAY_FIELDS)
            fail("the line ends after " + std::to_string(count) + " numbers, expected " + kFields[count] + "; " + kForm);
        std::memcpy(&ray, fields, sizeof ray);
        return true;
    }

 private:
    std::string_view next() {
        while (at_ < text_.size() && is_space(text_[at_])) ++at_;
        begin_ = at_;
        if (at_ < text_.size() && text_[at_] == '#') return {};
        while (at_ < text_.size() && !is_space(text_[at_]) && text_[at_] != '#') ++at_;
        return text_.substr(begin_, at_ - begin_);
    }
    static std::string shown(std::string_view word) { return printable_line(std::string(word.substr(0, 40))); }
    [[noreturn]] void fail(const std::string& why) const {
        throw Error(Exit::usage, file_ + ":" + std::to_string(number_) + ":" + std::to_string(begin_ + 1) + ": " + why);
    }
    std::string_view text_;
    const std::string& file_;
    size_t number_, at_ = 0, begin_ = 0;
};

std::string hit_text(const rt_hit& hit) {
    return exact_text(hit.t) + ' ' + std::to_string(hit.prim) + ' ' + std::to_string(hit.instance) + ' ' + exact_text(hit.u) +
           ' ' + exact_text(hit.v);
}

}  // namespace

std::vector<rt_ray> parse_rays(std::string_view text, const std::string& file, RayOrigins* origins) {
    std::vector<rt_ray> rays;
    size_t number = 0;
    while (!text.empty()) {
        const size_t end = std::min(text.find('\n'), text.size());
        rt_ray ray{};
        std::array<double, 3> origin{};
        if (Line(text.substr(0, end), file, ++number).read(ray, origin)) {
            rays.push_back(ray);
            if (origins) origins->push_back(origin);
        }
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return rays;
}

std::vector<rt_ray> read_rays(const std::string& path, RayOrigins* origins) {
    if (path != "-") return parse_rays(read_file(path, kMaxRayFileBytes, Exit::failed), path, origins);
    std::string text;
    char piece[65536];
    for (size_t count = 0; (count = std::fread(piece, 1, sizeof piece, stdin)) > 0;) text.append(piece, count);
    return parse_rays(text, "stdin", origins);
}

std::string ray_text(const rt_ray& ray) {
    float fields[RT_RAY_FIELDS];
    std::memcpy(fields, &ray, sizeof fields);
    std::string text;
    for (const float field : fields) text += (text.empty() ? "" : " ") + exact_text(field);
    return text;
}

std::string hits_text(const std::vector<rt_hit>& hits, bool any_hit, const std::vector<RayWork>& work) {
    std::string text = any_hit ? "# occluded" : "# t prim instance u v";
    text += work.empty() ? "\n" : " nodes boxes tests\n";
    for (size_t i = 0; i < hits.size(); ++i) {
        text += any_hit ? hits[i].t == 0 ? "1" : "0" : hit_text(hits[i]);
        if (!work.empty())
            text += ' ' + std::to_string(hits[i].steps) + ' ' + std::to_string(work[i].boxes + work[i].own_boxes) + ' ' +
                    std::to_string(hits[i].leaf_tests);
        text += '\n';
    }
    return text;
}

std::string all_hits_text(const AllHits& all) {
    std::string text = "# ray t prim instance u v\n";
    for (size_t ray = 0; ray + 1 < all.first.size(); ++ray)
        for (uint64_t i = all.first[ray]; i < all.first[ray + 1]; ++i)
            text += std::to_string(ray) + ' ' + hit_text(all.hits[i]) + '\n';
    return text;
}

std::string counts_text(const AllHits& all) {
    std::string text = "# hits\n";
    for (size_t ray = 0; ray + 1 < all.first.size(); ++ray) text += std::to_string(all.count(ray)) + '\n';
    return text;
}

}  // namespace clarity
