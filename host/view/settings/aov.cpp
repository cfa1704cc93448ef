#include "view/settings/aov.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace clarity {

namespace {

using Film = Aov::Film;
using Paint = Aov::Paint;
using Map = FalseColorScale::Map;

// A bar from `min` on. whole: it shows a count.
FalseColorScale bar(Map map, const char* label, const char* unit, bool whole = false) {
    FalseColorScale scale;
    scale.map = map;
    scale.label = label;
    scale.unit = unit;
    scale.whole = whole;
    return scale;
}

Aov first_hit(const char* name, const char* help, Film film, Paint paint) {
    Aov aov;
    aov.name = name;
    aov.help = help;
    aov.about = Aov::About::first_hit;
    aov.tracer = "aov";
    aov.film = film;
    aov.paint = paint;
    return aov;
}

// An amount of work. Of the tracer `aov`: counted by its slower program.
Aov cost(const char* name, const char* help, Aov::Range range, FalseColorScale scale) {
    Aov aov = first_hit(name, help, Film::amounts, Paint::scale);
    aov.about = Aov::About::cost;
    aov.counts_steps = true;
    aov.range = range;
    aov.scale = std::move(scale);
    return aov;
}

Aov color() {
    Aov aov = first_hit("color", "colour", Film::colors, Paint::tones);
    aov.about = Aov::About::color;
    aov.tracer = nullptr;
    return aov;
}

Aov distance() {
    Aov aov = first_hit("t", "distance", Film::distances, Paint::scale);
    aov.scale = bar(Map::gray, "Distance", "scene units");
    return aov;
}

Aov generations() {
    Aov aov = cost("generations", "generations of rays", Aov::Range::counts, bar(Map::heat, "Generations", "of rays", true));
    aov.tracer = "iterative";
    aov.counts_steps = false;
    aov.scale.min = 1;
    aov.scale.max = 2;
    return aov;
}

// Of a sample; of one sample it is not known. The sign says whether the pixel rests.
float variance(const float* sum, const float* rest) {
    return sum[3] > 1 ? std::fabs(rest[3]) / (sum[3] - 1) : 0.0f;
}

// What the tracer `path` knows of its noise.
Aov noise(const char* name, const char* help, FalseColorScale scale, float (*of)(const float*, const float*)) {
    Aov aov = first_hit(name, help, Film::statistics, Paint::scale);
    aov.about = Aov::About::noise;
    aov.tracer = "path";
    aov.scale = std::move(scale);
    aov.statistic = of;
    return aov;
}

// The share of light that came by next-event estimation.
Aov by_next_event() {
    Aov aov = noise("mis", "share of light by next-event estimation", bar(Map::heat, "By next event", "share of light"),
                    [](const float* sum, const float*) { return sum[1] > 0 ? sum[0] / sum[1] : 0.0f; });
    aov.range = Aov::Range::share;
    return aov;
}

}  // namespace

const std::vector<Aov>& aov_table() {
    static const std::vector<Aov> table = {
        color(),
        distance(),
        first_hit("prim", "primitive", Film::numbers, Paint::hash),
        first_hit("instance", "instance", Film::numbers, Paint::hash),
        first_hit("normal", "normal", Film::vectors, Paint::direction),
        first_hit("uv", "texture coordinates", Film::vectors, Paint::texture),
        cost("steps", "nodes visited", Aov::Range::counts, bar(Map::heat, "Nodes visited", "per packet of rays", true)),
        cost("boxes", "boxes tested", Aov::Range::counts, bar(Map::heat, "Boxes tested", "per packet of rays", true)),
        cost("leaf_tests", "primitives tested", Aov::Range::counts,
             bar(Map::heat, "Primitives tested", "per packet of rays", true)),
        cost("lanes", "share of lanes alive per visit", Aov::Range::share,
             bar(Map::heat, "Lanes alive", "share per node visit")),
        generations(),
        noise("variance", "variance of the samples", bar(Map::heat, "Variance", "of a sample's luminance"), variance),
        noise("error", "standard error of the mean", bar(Map::heat, "Standard error", "of the mean luminance"),
              [](const float* sum, const float* rest) { return std::sqrt(variance(sum, rest) / sum[3]); }),
        noise("samples", "number of samples", bar(Map::heat, "Samples", "per pixel", true),
              [](const float* sum, const float*) { return sum[3]; }),
        by_next_event(),
    };
    return table;
}

const Aov& find_aov(const std::string& name) {
    for (const Aov& aov : aov_table())
        if (name == aov.name) return aov;
    throw std::out_of_range("no AOV `" + name + "`");
}

unsigned number_of(const Aov& aov) {
    return static_cast<unsigned>(&aov - aov_table().data());
}

std::string kernel_macro(const Aov& aov) {
    std::string macro = std::string("RT_AOV_") + aov.name;
    for (char& c : macro)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return macro;
}

std::vector<std::string> aov_names() {
    std::vector<std::string> names;
    for (const Aov& aov : aov_table()) names.emplace_back(aov.name);
    return names;
}

std::string aov_help() {
    const auto all_about = [](Aov::About about) {
        std::string list;
        for (const Aov& aov : aov_table())
            if (aov.about == about) list += (list.empty() ? "" : ", ") + std::string(aov.help);
        return list;
    };
    return all_about(Aov::About::color) + ", or of the first hit: " + all_about(Aov::About::first_hit) +
           "; or what it cost: " + all_about(Aov::About::cost) + "; or, of `path`, its noise: " + all_about(Aov::About::noise);
}

}  // namespace clarity
