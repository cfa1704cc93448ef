#include "mtl.hpp"

#include <algorithm>

#include "text.hpp"

namespace openmesh_import {
namespace {

// The statements of one material as written. Statements that are missing keep these defaults.
struct Statements {
    float diffuse[3] = {0.8f, 0.8f, 0.8f}, specular[3] = {0, 0, 0}, emission[3] = {0, 0, 0}, filter[3] = {1, 1, 1};
    float exponent = 1, ior = 1, dissolve = 1;
    bool has_diffuse = false, has_dissolve = false;
    int illumination = -1;
    ObjTexture texture, dissolve_map, emission_map, normal_map, bump_map;
};

// Statements of maps, lower case. `norm` is of the extension for physically based rendering, which Blender writes.
constexpr std::pair<std::string_view, ObjTexture Statements::*> kMaps[] = {
    {"map_kd", &Statements::texture},  {"map_d", &Statements::dissolve_map}, {"map_ke", &Statements::emission_map},
    {"norm", &Statements::normal_map}, {"map_bump", &Statements::bump_map},  {"bump", &Statements::bump_map},
};

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
    Statements statements_;
    bool is_open_ = false;
};

void Reader::leave_out(std::string_view what, std::string_view option) {
    std::string text = printable(what);
    if (!option.empty()) text += " " + printable(option);
    std::vector<std::string>& list = library_.left_out;
    constexpr size_t kMost = 20;
    if (list.size() >= kMost || std::find(list.begin(), list.end(), text) != list.end()) return;
    if (list.empty()) library_.first_left_out = name_;
    list.push_back(text);
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

float largest(const float c[3]) {
    return std::max({c[0], c[1], c[2]});
}

// Converts a material. Wavefront's illumination models: 3, 5 and 8 (without ray tracing) mirror; 4, 6, 7 and 9 are glass.
ObjMaterial finish(const Statements& s) {
    ObjMaterial m;
    const auto use = [&](rt_u32 use, rt_u32 space, const ObjTexture& texture) {
        if (!texture.names.empty()) m.maps.push_back({use, space, texture});
    };
    const bool alpha_of_color = s.dissolve_map.names == s.texture.names;
    use(RT_MAP_COLOR, RT_SPACE_SRGB, s.texture);
    use(RT_MAP_EMISSION, RT_SPACE_SRGB, s.emission_map);
    if (!s.normal_map.names.empty())
        use(RT_MAP_NORMAL, RT_SPACE_LINEAR, s.normal_map);
    else
        use(RT_MAP_NORMAL, RT_SPACE_HEIGHT, s.bump_map);
    if (!alpha_of_color) use(RT_MAP_OPACITY, RT_SPACE_LINEAR, s.dissolve_map);
    rt_material_desc& out = m.values;
    out.texture = RT_NONE;
    const bool mirrors = s.illumination == 3 || s.illumination == 5 || s.illumination == 8;
    const bool is_glass = s.illumination == 4 || s.illumination == 6 || s.illumination == 7 || s.illumination == 9;
    for (int k = 0; k < 3; ++k) {
        out.color[k] = std::min(s.diffuse[k], 1.0f);
        out.specular[k] = s.illumination == 0 || s.illumination == 1 ? 0 : std::min(s.specular[k], 1.0f);
        out.emission[k] = s.emission[k];
    }
    if (!s.texture.names.empty() && (!s.has_diffuse || largest(out.color) == 0)) std::fill(out.color, out.color + 3, 1.0f);
    // Programs leave Ke black beside its picture.
    if (!s.emission_map.names.empty() && largest(out.emission) == 0) std::fill(out.emission, out.emission + 3, 1.0f);
    out.shininess = std::clamp(s.exponent, 1.0f, 10000.0f);
    out.ior = 1;
    // `d` is the share of the surface that is there, unless it is glass. A map_d that names the picture of map_Kd means its
    // alpha; of another picture the red channel counts.
    const bool is_cut = !s.dissolve_map.names.empty();
    if (!is_glass && (s.dissolve < 1 || is_cut)) m.alpha.set(importers::AlphaKeys::blend, s.dissolve);
    if (is_glass) {
        out.refract = std::clamp(1 - s.dissolve, 0.0f, 1.0f);
        out.ior = s.ior > 1 ? std::min(s.ior, 10.0f) : 1.5f;
        if (!s.has_dissolve || s.dissolve >= 1) {
            // Glass without an opacity is clear. Its hue is that of the transmission filter; the filter's strength is ignored,
            // because programs write it in either sense. The diffuse colour keeps its share of the light.
            out.refract = 1 - largest(out.color);
            const float strongest = std::max(largest(s.filter), 1e-6f);
            for (int k = 0; k < 3; ++k) out.color[k] = s.filter[k] / strongest;
        }
    }
    if (mirrors) out.reflect = std::min(largest(s.specular), 1 - out.refract);
    return m;
}

void Reader::close() {
    if (!is_open_) return;
    ObjMaterial material = finish(statements_);
    material.folder = folder_;
    library_.materials[name_] = std::move(material);
}

void Reader::statement(std::string_view word, std::string_view line) {
    Statements& s = statements_;
    const std::pair<std::string_view, float*> colors[] = {
        {"kd", s.diffuse}, {"ks", s.specular}, {"ke", s.emission}, {"tf", s.filter}};
    for (const auto& [key, to] : colors) {
        if (!is_word(word, key)) continue;
        color(word, line, to);
        s.has_diffuse = s.has_diffuse || to == s.diffuse;
        return;
    }
    for (const auto& [key, texture] : kMaps)
        if (is_word(word, key)) return map(word, line, s.*texture);
    ObjTexture ignored;
    float number = 0;
    if (is_word(word.substr(0, 4), "map_") || is_word(word, "disp") || is_word(word, "decal") || is_word(word, "refl")) {
        map(word, line, ignored);
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
    } else if (!parse_float(next_word(line), number)) {
        return;
    } else if (is_word(word, "ns")) {
        s.exponent = number;
    } else if (is_word(word, "ni")) {
        s.ior = number;
    } else if (is_word(word, "illum")) {
        s.illumination = number >= 0 && number <= 10 ? static_cast<int>(number) : -1;
    } else if (is_word(word, "tr") && !s.has_dissolve) {
        s.dissolve = 1 - number;
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
    if (library.left_out.empty()) library.first_left_out = own.first_left_out;
    library.left_out.insert(library.left_out.end(), own.left_out.begin(), own.left_out.end());
}

}  // namespace openmesh_import
