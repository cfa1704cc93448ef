#include "mtl.hpp"

#include <algorithm>

#include "mtl_surface.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

// Statements of maps, lower case; those of kPbr come besides. `norm` is of the extension for physically based rendering.
constexpr std::pair<std::string_view, ObjTexture MtlStatements::*> kMaps[] = {
    {"map_kd", &MtlStatements::texture},      {"map_d", &MtlStatements::dissolve_map},
    {"map_ke", &MtlStatements::emission_map}, {"norm", &MtlStatements::normal_map},
    {"map_norm", &MtlStatements::normal_map}, {"map_kn", &MtlStatements::normal_map},
    {"map_bump", &MtlStatements::bump_map},   {"bump", &MtlStatements::bump_map},
    {"map_tf", &MtlStatements::filter_map},   {"map_ks", &MtlStatements::specular_map},
};
// Statements that change nothing here, so that no warning is worth it: `ambient` is the scene's, not a material's, and maps
// are smooth.
constexpr std::string_view kWithoutEffect[] = {"ka", "map_ka", "map_aat", "sharpness"};

// Options of maps, from Wavefront's appendix B1, "MTL material format". `least` to `most` values follow; `unless` is the value
// that changes nothing, so that it is not worth a warning.
struct Option {
    std::string_view word;
    int least, most;
    std::string_view unless;
};
constexpr Option kOptions[] = {
    {"-s", 1, 3, ""},      {"-o", 1, 3, ""},       {"-t", 1, 3, "0 0 0"}, {"-mm", 1, 2, "0 1"},    {"-bm", 1, 1, "1"},
    {"-boost", 1, 1, "0"}, {"-texres", 1, 1, ""},  {"-clamp", 1, 1, ""},  {"-blendu", 1, 1, "on"}, {"-blendv", 1, 1, "on"},
    {"-cc", 1, 1, "off"},  {"-imfchan", 1, 1, ""}, {"-type", 1, 1, ""},
};

// Whether a word may be the value of an option. Numbers are the values of all options that have several.
bool is_value(const Option& option, std::string_view word, int index) {
    float number;
    return !word.empty() && (index < option.least ? option.most == 1 || parse_float(word, number) : parse_float(word, number));
}

// Whether two texts have the same words, or numbers of the same values.
bool is_same(std::string_view a, std::string_view b) {
    for (;;) {
        const std::string_view x = next_word(a), y = next_word(b);
        if (x.empty() || y.empty()) return x.empty() && y.empty();
        float p, q;
        if (!is_word(x, y) && !(parse_float(x, p) && parse_float(y, q) && p == q)) return false;
    }
}

class Reader {
 public:
    Reader(std::string_view text, const std::string& folder, Library& library)
        : lines_(text), folder_(folder), library_(library) {}
    void read() {
        for (std::string_view line; lines_.next_joined(line);) {
            line = trim(line);
            if (line.empty() || line.front() == '#') continue;
            const std::string_view word = next_word(line);
            if (is_word(word, "newmtl")) {
                close();
                name_ = std::string(without_quotes(trim(line)));
                statements_ = {};
                left_out_.clear();
                is_open_ = true;
            } else {
                statement(word, line);
            }
        }
        close();
    }

 private:
    void close();
    void statement(std::string_view word, std::string_view line);
    void leave_out(std::string_view what, std::string_view option = {});
    void color(std::string_view word, std::string_view rest, float out[3]);
    void map(std::string_view word, std::string_view rest, ObjTexture& out);

    Lines lines_;
    const std::string& folder_;
    Library& library_;
    std::string name_;
    MtlStatements statements_;
    std::vector<std::string> left_out_;  // of this material, each once
    bool is_open_ = false;
};

void Reader::leave_out(std::string_view what, std::string_view option) {
    std::string text = printable(what);
    if (!option.empty()) text += " " + printable(option);
    constexpr size_t kMost = 20;
    if (left_out_.size() < kMost && std::find(left_out_.begin(), left_out_.end(), text) == left_out_.end())
        left_out_.push_back(text);
}

void Reader::color(std::string_view word, std::string_view rest, float out[3]) {
    float rgb[3];
    const std::string_view first = next_word(rest);
    if (is_word(first, "spectral") || is_word(first, "xyz")) leave_out(word, first);
    if (!parse_float(first, rgb[0])) return;
    // One number stands for all three channels.
    if (!parse_float(next_word(rest), rgb[1]) || !parse_float(next_word(rest), rgb[2])) rgb[1] = rgb[2] = rgb[0];
    for (int k = 0; k < 3; ++k) out[k] = std::clamp(rgb[k], 0.0f, 10000.0f);
}

// Reads, for example, `-s 1 1 1 -clamp on wood grain.png`: options first, then a file name.
void Reader::map(std::string_view word, std::string_view rest, ObjTexture& out) {
    out = {};
    rest = trim(rest);
    // Names that begin with numbers of the last option, which may have fewer values: `-s 2 2 4 boards.png`.
    std::vector<std::string_view> starts;
    while (!rest.empty() && rest.front() == '-') {
        std::string_view ahead = rest;
        const std::string_view option = next_word(ahead);
        const auto known =
            std::find_if(std::begin(kOptions), std::end(kOptions), [&](const Option& o) { return is_word(option, o.word); });
        if (known == std::end(kOptions)) break;  // a name that begins with '-'
        starts.clear();
        const std::string_view values = trim(ahead);
        float numbers[3] = {0, 0, 0};
        std::string_view first;
        int count = 0;
        for (; count < known->most; ++count) {
            const std::string_view before = ahead, value = next_word(ahead);
            if (!is_value(*known, value, count)) {
                ahead = before;
                break;
            }
            if (count == 0) first = value;
            if (count >= known->least) starts.push_back(trim(before));
            parse_float(value, numbers[count]);
        }
        rest = trim(ahead);
        if (known->word == "-s" || known->word == "-o") {
            float* const to = known->word == "-s" ? out.scale : out.offset;
            for (int k = 0; k < 2 && k < count; ++k) to[k] = numbers[k];
        } else if (known->word == "-clamp") {
            out.clamped = is_word(first, "on");
        } else if (known->word == "-bm" && &out == &statements_.bump_map) {
            out.bump = numbers[0];
        } else if (!is_same(values.substr(0, static_cast<size_t>(rest.data() - values.data())), known->unless)) {
            leave_out(word, known->word);
        }
    }
    // A name with fewer values of the last option before it, and each name without what may be a comment.
    starts.insert(starts.begin(), rest);
    for (const std::string_view start : starts) {
        const size_t first_size = start.size();
        for (size_t size = first_size; size > 0;) {
            const std::string_view name = without_quotes(trim(start.substr(0, size)));
            if (!name.empty()) out.names.emplace_back(name);
            size_t comment = start.substr(0, size).rfind('#');
            while (comment != start.npos && comment > 0 && !is_blank(start[comment - 1]))
                comment = start.substr(0, comment).rfind('#');
            size = comment == start.npos ? 0 : comment;
            if (out.names.size() > 8) return;
        }
    }
}

void Reader::close() {
    if (!is_open_) return;
    ObjMaterial material = to_material(statements_);
    const bool has_strengths = std::any_of(material.maps.begin(), material.maps.end(),
                                           [](const ObjMap& map) { return map.use == RT_MAP_SPECULAR_COLOR; });
    if (!statements_.specular_map.names.empty() && !has_strengths) leave_out("map_Ks");
    for (const std::string& statement : material.left_out) leave_out(statement);
    material.folder = folder_;
    material.left_out = std::move(left_out_);
    library_.materials[name_] = std::move(material);
}

void Reader::statement(std::string_view word, std::string_view line) {
    MtlStatements& s = statements_;
    const std::pair<std::string_view, float*> colors[] = {
        {"kd", s.diffuse}, {"ks", s.specular}, {"ke", s.emission}, {"tf", s.filter}};
    for (const auto& [key, to] : colors) {
        if (!is_word(word, key)) continue;
        color(word, line, to);
        s.has_diffuse = s.has_diffuse || to == s.diffuse;
        s.has_specular = s.has_specular || to == s.specular;
        s.has_filter = s.has_filter || to == s.filter;
        return;
    }
    for (const auto& [key, texture] : kMaps)
        if (is_word(word, key)) return map(word, line, s.*texture);
    float number = 0;
    for (size_t i = 0; i < kPbrCount; ++i) {
        if (is_word(word, kPbr[i].map_word)) return map(word, line, s.pbr_maps[i]);
        if (!is_word(word, kPbr[i].word)) continue;
        if (parse_float(next_word(line), number)) s.pbr[i] = number;
        return;
    }
    const auto is_this = [&](std::string_view known) { return is_word(word, known); };
    if (std::any_of(std::begin(kWithoutEffect), std::end(kWithoutEffect), is_this)) return;
    if (is_word(word, "illum")) {
        const bool is_known = parse_float(next_word(line), number) && number >= 0 && number < 10;
        s.illumination = is_known ? static_cast<int>(number) : -1;
        if (!is_known) leave_out(word);  // 10 has shadows on surfaces that are not seen
    } else if (is_word(word, "d")) {
        std::string_view value = next_word(line);
        if (is_word(value, "-halo")) {
            leave_out(word, value);
            value = next_word(line);
        }
        if (parse_float(value, number)) {
            s.dissolve = number;
            s.has_dissolve = true;
        }
    } else if (is_word(word, "ns")) {
        parse_float(next_word(line), s.exponent);
    } else if (is_word(word, "ni")) {
        parse_float(next_word(line), s.ior);
    } else if (is_word(word, "tr")) {
        if (!s.has_dissolve && parse_float(next_word(line), number)) s.dissolve = 1 - number;
    } else {
        leave_out(word);
    }
}

}  // namespace

const ObjMaterial* Library::find(std::string_view name) const {
    const auto exact = [&](std::string_view wanted) {
        const auto found = materials.find(wanted);
        return found == materials.end() ? nullptr : &found->second;
    };
    if (const ObjMaterial* found = exact(name)) return found;
    // The material's name with a comment behind it in the library.
    for (auto at = materials.lower_bound(name); at != materials.end(); ++at) {
        const std::string_view known = at->first;
        if (known.substr(0, name.size()) != name) break;
        const std::string_view more = known.substr(name.size());
        if (is_blank(more.front()) && trim(more).front() == '#') return &at->second;
    }
    // Or where it is used.
    for (size_t at = comment_in_name(name); at != name.npos; at = comment_in_name(name, at + 1)) {
        const ObjMaterial* found = exact(without_quotes(trim(name.substr(0, at))));
        if (found) return found;
    }
    return nullptr;
}

void parse_mtl(std::string_view text, const std::string& folder, Library& library) {
    Library own;
    Reader(text, folder, own).read();
    library.materials.insert(own.materials.begin(), own.materials.end());
}

}  // namespace openmesh_import
