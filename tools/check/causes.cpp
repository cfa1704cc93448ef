#include "tools/check/causes.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

namespace clarity::check {
namespace {

// A failure belongs to the row with the longest `check` that begins its check's name, and of these to the one with its `asked`,
// or with none. Stages are in the order in which they depend on each other: what fails at one may
// make the checks of later ones fail. Checks without a row depend on no other.
struct Row {
    const char *stage, *check;
    Asked asked = Asked::nothing;
};
constexpr Row kRows[] = {
    {"start", "builds.start"},
    {"start", "hits.start"},
    {"start", "imports.start"},
    {"start", "keys.start"},
    {"start", "shape.start"},
    {"start", "surface.start"},
    {"build", "builds.sound"},
    {"build", "builds.refs"},
    {"build", "builds.pack"},
    {"reading", "imports.read"},
    {"values", "keys.values"},
    {"fresh memory", "imports.memory"},
    {"state", "imports.state"},
    {"truth", "imports.truth"},
    {"bounds", "builds.bounds"},
    {"compilation", "hits.kernels"},
    {"compilation", "surface.kernels"},
    {"numbers", "surface.finite"},
    {"nearest hits of one lane", "hits.", Asked::nearest_one_lane},
    {"any-hit queries of one lane", "hits.", Asked::any_one_lane},
    {"hits", "hits."},
    {"hits", "hits.box"},
    {"hits", "hits.again"},
    {"hits", "hits.length"},
    {"hits", "hits.grazing"},
    {"nearest hits of several lanes", "hits.", Asked::nearest_lanes},
    {"any-hit queries of several lanes", "hits.", Asked::any_lanes},
    {"several lanes", "hits.lanes"},
    {"surface", "surface."},
    {"instances", "hits.instances"},
    {"instances", "hits.nested"},
    {"scenes", "hits.placed"},
    {"stack", "hits.stack"},
    {"stack", "hits.pushes"},
    {"accesses", "accesses."},
    {"build with other parameters", "builds.parameters"},
    {"ends of keys", "keys.ends"},
    {"hits at the ends of keys", "hits.ends"},
    {"refit", "builds.refit"},
    {"refit", "hits.refit"},
    {"work on the device", "builds.device"},
    {"work on the device", "hits.device"},
    {"texture coordinates", "surface.uv"},
};

// The end of kRows: none.
const Row* row_of(const CheckResult& result) {
    const auto fit = [&](const Row& row) -> std::pair<size_t, bool> {
        const bool is_asked = row.asked != Asked::nothing;
        if (result.name.rfind(row.check, 0) != 0 || (is_asked && row.asked != result.outcome.asked)) return {0, false};
        return {std::strlen(row.check), is_asked};
    };
    const Row* const best =
        std::max_element(std::begin(kRows), std::end(kRows), [&](const Row& a, const Row& b) { return fit(a) < fit(b); });
    return fit(*best).first > 0 ? best : std::end(kRows);
}

}  // namespace

std::string stage_of(const CheckResult& result) {
    const Row* const row = row_of(result);
    return row == std::end(kRows) ? "" : row->stage;
}

std::vector<Cause> causes_of(const std::vector<CheckResult>& results) {
    std::vector<size_t> failed;
    for (size_t i = 0; i < results.size(); ++i)
        if (results[i].outcome.kind == Outcome::Kind::failed) failed.push_back(i);
    const auto place_of = [&](size_t i) {  // of the stage
        return std::find_if(std::begin(kRows), std::end(kRows),
                            [stage = stage_of(results[i])](const Row& row) { return row.stage == stage; });
    };
    std::stable_sort(failed.begin(), failed.end(), [&](size_t a, size_t b) { return place_of(a) < place_of(b); });
    std::vector<Cause> causes;
    const auto has_found = [&](const Cause& cause, const std::string& found) {
        return std::any_of(cause.results.begin(), cause.results.end(),
                           [&](size_t i) { return results[i].outcome.found == found; });
    };
    for (const size_t i : failed) {
        const std::string stage = stage_of(results[i]);
        // Checks without a stage come last, each with a cause of its own, unless it found just what another one found.
        auto cause = stage.empty()
                         ? std::find_if(causes.begin(), causes.end(),
                                        [&](const Cause& other) { return has_found(other, results[i].outcome.found); })
                         : causes.begin();
        if (cause == causes.end()) cause = causes.insert(causes.end(), {stage, {}});
        cause->results.push_back(i);
    }
    return causes;
}

}  // namespace clarity::check
