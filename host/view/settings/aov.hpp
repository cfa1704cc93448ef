// aov.hpp -- the quantities that a picture may show: its colours, or another quantity of each pixel (AOV: arbitrary output
// variable). Each is one row of a table. Names, help, kernel, film format and display all follow from that row.
#pragma once
#include <string>
#include <vector>

#include "view/settings/false_color_scale.hpp"

namespace clarity {

// One row of the table.
struct Aov {
    // The format of a film's pixel. colors: sums of r, g, b and the number of samples. numbers: the bits of an int, -1: none.
    // vectors: three floats. distances, amounts: one float. statistics: as colors, with the second plane of
    // cl/tracers/path/sum.h; of them comes one float.
    enum class Film { colors, distances, amounts, numbers, vectors, statistics };
    // How values become colours. tones: exposure and tone mapping. scale: a position on the colour bar. hash: one colour for
    // each number. direction: x, y, z to r, g, b. texture: u, v to r, g.
    enum class Paint { tones, scale, hash, direction, texture };
    // The ends of the scale. measured: the smallest and the largest value. counts: from scale.min to the largest value. share:
    // 0 to 1.
    enum class Range { measured, counts, share };
    // What the quantity describes, for the help text.
    enum class About { color, first_hit, cost, noise };

    const char* name;  // as in --aov; aov.cl has it in capitals: RT_AOV_NAME
    const char* help;
    About about;
    const char* tracer;  // the id of the tracer that makes it; null: of that which the user has chosen
    Film film;
    Paint paint;
    bool counts_steps = false;  // needs a slower program, which counts nodes and primitives
    Range range = Range::measured;
    FalseColorScale scale = {};  // without the ends, which depend on the picture

    bool is_color() const { return film == Film::colors; }
    // Whether it needs several samples.
    bool adds_samples() const { return is_color() || film == Film::statistics; }
    // Of statistics. sum: light of the samples and their number; rest: the second plane, whose last number is the sum of
    // squared deviations of luminance.
    float (*statistic)(const float* sum, const float* rest) = nullptr;
    // Floats for each pixel: in the film, and in an image of its values.
    unsigned film_channels() const { return adds_samples() ? 4 : film == Film::vectors ? 3 : 1; }
    unsigned value_channels() const { return film == Film::colors || film == Film::vectors ? 3 : 1; }
};

// All AOVs. The first is the default.
const std::vector<Aov>& aov_table();
// Returns the row of that name. Throws std::out_of_range for unknown names, which settings never contain.
const Aov& find_aov(const std::string& name);
// Returns the number of a row of the table, and the name of the macro that kernels use for it: RT_AOV_T, RT_AOV_LEAF_TESTS.
unsigned number_of(const Aov& aov);
std::string kernel_macro(const Aov& aov);
// Returns the names in the table's order, and one sentence that describes them all.
std::vector<std::string> aov_names();
std::string aov_help();

}  // namespace clarity
