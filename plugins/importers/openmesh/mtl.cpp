#include "mtl.hpp"

#include <algorithm>
#include <string_view>

#include "text.hpp"

namespace openmesh_import {
namespace {

// The statements of one material as written. Statements that are missing keep these defaults.
struct Statements {
    float diffuse[3] = {0.8f, 0.8f, 0.8f}, specular[3] = {0, 0, 0}, emission[3] = {0, 0, 0}, filter[3] = {1, 1, 1};
    float exponent = 1, ior = 1, dissolve = 1;
    bool has_diffuse = false, has_dissolve = false;
    int illumination = -1;
    std::string texture;
};

void read_color(std::string_view rest, float out[3]) {
    float rgb[3];
    if (!parse_float(next_word(rest), rgb[0])) return;
    // One number stands for all three channels.
    if (!parse_float(next_word(rest), rgb[1]) || !parse_float(next_word(rest), rgb[2])) rgb[1] = rgb[2] = rgb[0];
    for (int k = 0; k < 3; ++k) out[k] = std::clamp(rgb[k], 0.0f, 10000.0f);
}

// Reads, for example, `-s 1 1 1 -clamp on wood grain.png`: options first, then a file name that may contain spaces.
std::string read_file_name(std::string_view rest) {
    rest = trim(rest);
    while (!rest.empty() && rest.front() == '-') {
        next_word(rest);
        for (;;) {
            std::string_view ahead = rest;
            const std::string_view word = next_word(ahead);
            float number;
            if (!parse_float(word, number) && word != "on" && word != "off") break;
            rest = ahead;
        }
        rest = trim(rest);
    }
    return std::string(rest);
}

float largest(const float c[3]) {
    return std::max({c[0], c[1], c[2]});
}

// Converts a material. Wavefront's illumination models: 3, 5 and 8 (without ray tracing) mirror; 4, 6, 7 and 9 are glass.
ObjMaterial finish(const Statements& s) {
    ObjMaterial m;
    m.texture = s.texture;
    rt_material_desc& out = m.values;
    out.texture = RT_NONE;
    const bool mirrors = s.illumination == 3 || s.illumination == 5 || s.illumination == 8;
    const bool is_glass = s.illumination == 4 || s.illumination == 6 || s.illumination == 7 || s.illumination == 9;
    for (int k = 0; k < 3; ++k) {
        out.color[k] = std::min(s.diffuse[k], 1.0f);
        out.specular[k] = s.illumination == 0 || s.illumination == 1 ? 0 : std::min(s.specular[k], 1.0f);
        out.emission[k] = s.emission[k];
    }
    if (!s.texture.empty() && (!s.has_diffuse || largest(out.color) == 0)) std::fill(out.color, out.color + 3, 1.0f);
    out.shininess = std::clamp(s.exponent, 1.0f, 10000.0f);
    out.refract = std::clamp(1 - s.dissolve, 0.0f, 1.0f);
    out.ior = 1;
    if (is_glass) {
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

}  // namespace

void parse_mtl(std::string_view text, std::map<std::string, ObjMaterial>& materials) {
    std::string name;
    Statements statements;
    bool is_open = false;
    const auto close = [&] {
        if (is_open) materials[name] = finish(statements);
    };
    while (!text.empty()) {
        std::string_view line = trim(before_comment(next_line(text)));
        const std::string_view word = next_word(line);
        float number = 0;
        if (word == "newmtl") {
            close();
            name = std::string(trim(line));
            statements = {};
            is_open = true;
        } else if (word == "Kd") {
            read_color(line, statements.diffuse);
            statements.has_diffuse = true;
        } else if (word == "Ks") {
            read_color(line, statements.specular);
        } else if (word == "Ke") {
            read_color(line, statements.emission);
        } else if (word == "Tf") {
            read_color(line, statements.filter);
        } else if (word == "map_Kd") {
            statements.texture = read_file_name(line);
        } else if (word == "Ns" && parse_float(next_word(line), number)) {
            statements.exponent = number;
        } else if (word == "Ni" && parse_float(next_word(line), number)) {
            statements.ior = number;
        } else if (word == "illum" && parse_float(next_word(line), number)) {
            statements.illumination = number >= 0 && number <= 10 ? static_cast<int>(number) : -1;
        } else if (word == "d" && parse_float(next_word(line), number)) {
            statements.dissolve = number;
            statements.has_dissolve = true;
        } else if (word == "Tr" && !statements.has_dissolve && parse_float(next_word(line), number)) {
            statements.dissolve = 1 - number;
        }
    }
    close();
}

}  // namespace openmesh_import
