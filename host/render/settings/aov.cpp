#include "render/settings/aov.hpp"

#include <cmath>
#include <stdexcept>

namespace clarity {
namespace {

// Of a sample; of one sample it is not known.
float variance(const float* sum, const float* rest) {
    return sum[3] > 1 ? rest[3] / (sum[3] - 1) : 0.0f;
}

// A row of what the tracer `path` knows of its noise.
Aov statistic(const char* name, const char* help, FalseColorScale scale, float (*of)(const float*, const float*)) {
    Aov aov{name,  help, Aov::About::noise, "path", Aov::Film::statistics, Aov::Paint::scale, false, Aov::Range::measured,
            scale, of};
    if (std::string(name) == "mis") aov.range = Aov::Range::share;
    return aov;
}

}  // namespace

const std::vector<Aov>& aov_table() {
    using About = Aov::About;
    using Film = Aov::Film;
    using Paint = Aov::Paint;
    using Range = Aov::Range;
    using Map = FalseColorScale::Map;
    static const std::vector<Aov> table = {
        {"color", "colour", About::color, nullptr, Film::colors, Paint::tones},
        {"t",
         "distance",
         About::first_hit,
         "aov",
         Film::distances,
         Paint::scale,
         false,
         Range::measured,
         {Map::gray, 0, 1, false, "Distance", "scene units"}},
        {"prim", "primitive", About::first_hit, "aov", Film::numbers, Paint::hash},
        {"instance", "instance", About::first_hit, "aov", Film::numbers, Paint::hash},
        {"normal", "normal", About::first_hit, "aov", Film::vectors, Paint::direction},
        {"uv", "texture coordinates", About::first_hit, "aov", Film::vectors, Paint::texture},
        {"steps",
         "nodes visited",
         About::cost,
         "aov",
         Film::amounts,
         Paint::scale,
         true,
         Range::counts,
         {Map::heat, 0, 1, true, "Nodes visited", "per packet of rays"}},
        {"leaf_tests",
         "primitives tested",
         About::cost,
         "aov",
         Film::amounts,
         Paint::scale,
         true,
         Range::counts,
         {Map::heat, 0, 1, true, "Primitives tested", "per packet of rays"}},
        {"lanes",
         "share of lanes alive per visit",
         About::cost,
         "aov",
         Film::amounts,
         Paint::scale,
         true,
         Range::share,
         {Map::heat, 0, 1, false, "Lanes alive", "share per node visit"}},
        {"generations",
         "generations of rays",
         About::cost,
         "iterative",
         Film::amounts,
         Paint::scale,
         false,
         Range::counts,
         {Map::heat, 1, 2, true, "Generations", "of rays"}},
        statistic("variance", "variance of the samples", {Map::heat, 0, 1, false, "Variance", "of a sample's luminance"},
                  [](const float* sum, const float* rest) { return variance(sum, rest); }),
        statistic("error", "standard error of the mean", {Map::heat, 0, 1, false, "Standard error", "of the mean luminance"},
                  [](const float* sum, const float* rest) { return std::sqrt(variance(sum, rest) / sum[3]); }),
        statistic("samples", "number of samples", {Map::heat, 0, 1, true, "Samples", "per pixel"},
                  [](const float* sum, const float*) { return sum[3]; }),
        statistic("mis", "share of light by next-event estimation", {Map::heat, 0, 1, false, "By next event", "share of light"},
                  [](const float* sum, const float*) { return sum[1] > 0 ? sum[0] / sum[1] : 0.0f; }),
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
