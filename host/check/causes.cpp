#include "check/causes.hpp"

#include <algorithm>
#include <iterator>

namespace clarity::check {
namespace {

// A failure belongs to the first row whose `check` begins its check's name, and whose `found` is in what the check found. What
// fails at a stage may make the checks of later stages fail. Checks without a row depend on no other.
struct Row {
    const char *check, *found, *stage;
};
constexpr Row kRows[] = {
    // structures
    {"builds.start", "", "start"},
    {"hits.start", "", "start"},
    {"imports.start", "", "start"},
    {"keys.start", "", "start"},
    {"shape.start", "", "start"},
    {"builds.sound", "", "build"},
    {"builds.refs", "", "build"},
    {"builds.pack", "", "build"},
    {"builds.parameters", "", "build with other parameters"},
    {"builds.bounds", "", "bounds"},
    // importers
    {"imports.read", "", "reading"},
    {"imports.memory", "", "fresh memory"},
    {"imports.state", "", "state"},
    {"imports.truth", "", "truth"},
    // shapes
    {"keys.values", "", "values"},
    {"keys.ends", "", "ends of keys"},
    // kernels of structures and shapes
    {"hits.kernels", "", "compilation"},
    {"hits.stack", "", "stack"},
    {"hits.box", "", "hits"},
    {"hits.again", "", "hits"},
    {"hits.length", "", "hits"},
    {"hits.grazing", "", "hits"},
    {"hits.lanes", "", "several lanes"},
    {"hits.ends", "", "hits at the ends of keys"},
    {"surface.uv", "", "texture coordinates"},
    {"surface.", "", "surface"},
    {"hits.placed", "", "scenes"},
    {"hits.refit", "", "refit"},
    {"builds.refit", "", "refit"},
    {"builds.device", "", "work on the device"},
    {"hits.device", "", "work on the device"},
    {"hits.instances", "", "instances"},
    {"hits.nested", "", "instances"},
    {"hits.", "nearest hits with 1 lane", "nearest hits of one lane"},
    {"hits.", "any-hit queries with 1 lane", "any-hit queries of one lane"},
    {"hits.", "nearest hits with ", "nearest hits of several lanes"},
    {"hits.", "any-hit queries with ", "any-hit queries of several lanes"},
    {"hits.", "", "hits"},
    {"accesses.", "", "accesses"},
};
// The stages in the order in which they depend on each other.
constexpr const char* kOrder[] = {"start",
                                  "build",
                                  "reading",
                                  "values",
                                  "fresh memory",
                                  "state",
                                  "truth",
                                  "bounds",
                                  "compilation",
                                  "nearest hits of one lane",
                                  "any-hit queries of one lane",
                                  "hits",
                                  "nearest hits of several lanes",
                                  "any-hit queries of several lanes",
                                  "several lanes",
                                  "surface",
                                  "instances",
                                  "scenes",
                                  "stack",
                                  "accesses",
                                  "build with other parameters",
                                  "ends of keys",
                                  "hits at the ends of keys",
                                  "refit",
                                  "work on the device",
                                  "texture coordinates"};

const Row* row_of(const CheckResult& result) {
    for (const Row& row : kRows)
        if (result.name.rfind(row.check, 0) == 0 && result.outcome.found.find(row.found) != std::string::npos) return &row;
    return nullptr;
}

size_t place_of(const std::string& stage) {
    return static_cast<size_t>(std::find(std::begin(kOrder), std::end(kOrder), stage) - std::begin(kOrder));
}

}  // namespace

std::string stage_of(const CheckResult& result) {
    const Row* const row = row_of(result);
    return row ? row->stage : "";
}

std::vector<Cause> causes_of(const std::vector<CheckResult>& results) {
    std::vector<size_t> failed;
    for (size_t i = 0; i < results.size(); ++i)
        if (results[i].outcome.kind == Outcome::Kind::failed) failed.push_back(i);
    std::stable_sort(failed.begin(), failed.end(),
                     [&](size_t a, size_t b) { return place_of(stage_of(results[a])) < place_of(stage_of(results[b])); });
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
