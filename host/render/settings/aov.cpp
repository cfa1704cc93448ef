#include "render/settings/aov.hpp"

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
        cost("leaf_tests", "primitives tested", Aov::Range::counts,
             bar(Map::heat, "Primitives tested", "per packet of rays", true)),
        cost("lanes", "share of lanes alive per visit", Aov::Range::share,
             bar(Map::heat, "Lanes alive", "share per node visit")),
        generations(),
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
           "; or what it cost: " + all_about(Aov::About::cost);
}

}  // namespace clarity
