// aov.hpp -- what a picture may show: its colours, or another quantity of each pixel (AOV: arbitrary output variable). One
// table: names, help, the kernel, what is in the film and how it is read and shown all follow from a row.
#pragma once
#include <string>
#include <vector>

#include "render/settings/false_color_scale.hpp"

namespace clarity {

struct Aov {
    // Which program makes it: the tracer; the iterative tracer, counting generations; or cl/tracers/aov.cl.
    enum class Program { color, generations, camera_rays };
    // What a pixel of the film is. colors: sums of r, g, b and their number; numbers: an int in the bits of a float, -1: none.
    enum class Film { colors, distances, amounts, numbers, vectors };
    // How values become colours. tones: exposure and tone mapping. scale: along the colour bar. hash: a colour a number.
    // direction: x, y, z to r, g, b. texture: u, v to r, g.
    enum class Paint { tones, scale, hash, direction, texture };
    // The scale's ends. measured: the least and the largest value. counts: from scale.min to the largest. share: 0 to 1.
    enum class Range { measured, counts, share };
    // What it tells of, for the help text.
    enum class About { color, first_hit, cost };

    const char* name;  // as in --aov, and in capitals in aov.cl: RT_AOV_NAME
    const char* help;
    About about;
    Program program;
    Film film;
    Paint paint;
    bool counts_steps = false;  // needs a program that counts nodes and primitives, which is slower
    Range range = Range::measured;
    FalseColorScale scale = {};  // but for the ends that the picture decides

    bool is_color() const { return film == Film::colors; }
    // Floats a pixel: in the film, and in a picture of its values.
    unsigned film_channels() const { return film == Film::colors ? 4 : film == Film::vectors ? 3 : 1; }
    unsigned value_channels() const { return film == Film::colors || film == Film::vectors ? 3 : 1; }
};

// The first is the default.
const std::vector<Aov>& aov_table();
// A name of the table. Throws std::out_of_range for others: settings hold none.
const Aov& find_aov(const std::string& name);
// RT_AOV_T, RT_AOV_LEAF_TESTS: what kernels call it. Its value is its number in the table.
std::string kernel_macro(const Aov& aov);
// The names in the table's order, and one sentence that describes them all.
std::vector<std::string> aov_names();
std::string aov_help();

}  // namespace clarity
