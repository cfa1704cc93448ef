#include "render/tracers/replay/sampler_points.hpp"

#include <algorithm>

#include "base/numbers.hpp"

namespace clarity {

std::string dimension_name(unsigned dimension) {
    static const char* const of_camera[] = {"pixel x", "pixel y", "lens u", "lens v"};
    static const char* const of_event[] = {"lobe",       "direction u", "direction v", "roulette",
                                           "light pick", "light u",     "light v",     "light tree"};
    if (dimension < 4) return of_camera[dimension];
    return "event " + std::to_string((dimension - 4) / 8 + 1) + " " + of_event[(dimension - 4) % 8];
}

Strata strata_of(const SamplerPoints& points, unsigned across, unsigned up) {
    Strata strata;
    while (2 * strata.columns * strata.rows <= points.samples)
        (strata.columns <= strata.rows ? strata.columns : strata.rows) *= 2;
    std::vector<bool> filled(size_t(strata.columns) * strata.rows);
    const auto cell = [](float at, unsigned count) {
        return std::min(count - 1, static_cast<unsigned>(at * static_cast<float>(count)));
    };
    for (unsigned s = 0; s < points.samples; ++s)
        filled[size_t(cell(points.at(s, up), strata.rows)) * strata.columns + cell(points.at(s, across), strata.columns)] =
            true;
    strata.filled = static_cast<unsigned>(std::count(filled.begin(), filled.end(), true));
    return strata;
}

std::string points_csv(const SamplerPoints& points) {
    std::string text = "sample";
    for (unsigned d = 0; d < points.dimensions; ++d) text += "," + dimension_name(d);
    text += "\n";
    for (unsigned s = 0; s < points.samples; ++s) {
        text += std::to_string(s);
        for (unsigned d = 0; d < points.dimensions; ++d) text += "," + exact_text(points.at(s, d));
        text += "\n";
    }
    return text;
}

}  // namespace clarity
