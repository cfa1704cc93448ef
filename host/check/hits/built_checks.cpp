#include "check/hits/built_checks.hpp"

#include <algorithm>
#include <ctime>
#include <functional>
#include <set>

#include "check/builds/parameter_tries.hpp"
#include "check/hits/ray_maker.hpp"
#include "plugin/extensions.hpp"

namespace clarity::check {
namespace {

constexpr size_t kBuiltRays = 400;  // of a set
// Processor time for the compilation of kernels that differ in a define. What is cut is said.
constexpr double kQuick_s = 6, kLong_s = 60;
constexpr unsigned kLarge = 70000, kHuge = (1u << 20) + 4099;  // above 2^16 and 2^20

double processor_s() {
    return double(std::clock()) / CLOCKS_PER_SEC;
}

// The same with few rays, and for debugging alone.
BenchInput few(BenchInput input) {
    input.options.rays = kBuiltRays;
    input.options.quick = true;
    return input;
}

// Traces the mixed scene as it is built in one way after another, first where the program is there already: that of the default
// defines, with each number of lanes in turn. Each further set of defines is compiled with one number of lanes, which follows
// from its values: so all checks compile it once. Quick checks compile for one of the two least numbers, which takes the least
// time.
struct Case {
    std::string what;  // "bvh2,max_leaf=1"
    BuiltAs as;
};
Outcome trace_cases(const BenchInput& input, const std::vector<Case>& cases, const Step& step) {
    const double begin = processor_s(), most = input.options.quick ? kQuick_s : kLong_s;
    const auto usual = Bench(few(input)).scene(step).accel()->defines;
    struct Tried {
        std::string what;
        std::unique_ptr<Bench> bench;
        std::map<std::string, rt_u32> defines;
    };
    std::vector<Tried> left;
    for (const Case& one : cases) {
        auto bench = std::make_unique<Bench>(few(input), kMixedScene, one.as);
        auto defines = bench->scene(step).accel()->defines;
        left.push_back({one.what, std::move(bench), std::move(defines)});
    }
    size_t traced = 0;
    std::set<std::map<std::string, rt_u32>> programs;
    const auto turn_of = [](const std::map<std::string, rt_u32>& defines) {
        std::string text;
        for (const auto& [name, value] : defines) text += name + "=" + std::to_string(value) + " ";
        return std::hash<std::string>()(text);
    };
    for (; !left.empty() && processor_s() - begin < most; ++traced) {
        auto next = std::find_if(left.begin(), left.end(),
                                 [&](const Tried& t) { return t.defines == usual || programs.count(t.defines) > 0; });
        if (next == left.end()) next = left.begin();
        Bench& bench = *next->bench;
        programs.insert(next->defines);
        const size_t turn = turn_of(next->defines);
        bench.take_turn(next->defines == usual ? traced : input.options.quick ? turn % 2 : turn, step);
        Outcome outcome =
            trace_sets(bench, {"hits.random", "hits.instances", "hits.primitives", "hits.nested"}, "with " + next->what, step);
        if (outcome.kind == Outcome::Kind::failed) return outcome;
        left.erase(next);
    }
    const std::string all = std::to_string(cases.size());
    return Outcome::passed("rays are right in " + (left.empty()
                                                       ? "all " + all + " cases"
                                                       : std::to_string(traced) + " of " + all + " cases: cut after " +
                                                             std::to_string(static_cast<int>(most)) + " s of processor time"));
}

Outcome parameters(const BenchInput& input, const Step& step) {
    std::vector<Case> cases;
    for (const ParameterValues& params : parameter_tries(input.plugin, input.options.seed))
        cases.push_back({choice_text(input.plugin, params), {params, 0, {}, Moves::none}});
    if (cases.empty()) return Outcome::skipped("the plugin has no parameters");
    // All at their ends and in between first: they say most if time is short.
    std::rotate(cases.begin(), cases.end() - std::min<long>(4, static_cast<long>(cases.size())), cases.end());
    return trace_cases(input, cases, step);
}

Outcome packed(const BenchInput& input, const Step& step) {
    if (input.layout || !input.plugin.accel->pack) return Outcome::skipped("the plugin has no `pack`");
    std::vector<Case> cases;
    for (const rt_u32 leaf : {1u, 3u, 50u})
        cases.push_back({"a packed tree of leaves of " + std::to_string(leaf), {{}, leaf, {}, Moves::none}});
    return trace_cases(input, cases, step);
}

// What is built after a refit differs in defines from what was built before: quick checks compile that for one number of lanes.
Outcome refitted(const BenchInput& input, bool quick, const Step& step) {
    struct Row {
        const TestScene& scene;
        Moves moves;
        std::vector<const char*> sets;
    };
    Outcome outcome;
    for (const Row& row :
         {Row{kMixedScene, Moves::refitted, {"hits.random", "hits.instances", "hits.primitives", "hits.limits"}},
          Row{kMixedScene, Moves::rebuilt, {"hits.random", "hits.instances"}},
          Row{kRegularScene, Moves::refitted, {"hits.edges", "hits.uneven"}}}) {
        Bench bench(input, row.scene, {{}, 0, {}, row.moves});
        const bool again = row.moves == Moves::rebuilt;
        if (again && quick && bench.scene(step).accel()->defines != Bench(input).scene(step).accel()->defines)
            bench.take_turn(0, step);
        outcome = trace_sets(bench, row.sets, again ? "after a refit and a new build" : "after a refit", step);
        if (outcome.kind == Outcome::Kind::failed) break;
    }
    return outcome;
}

Scene nothing(uint64_t) {
    Scene scene;
    scene.materials.push_back({"default", default_material()});
    return scene;
}
std::vector<RaySet> rays_at_nothing(const BuildScene&, size_t count, uint64_t seed) {
    RayMaker make(9, seed);
    RaySet set{"hits.empty", "rays into a scene without primitives, whose world is an empty group", {}, false, ""};
    for (size_t i = 0; i < count; ++i) set.rays.push_back(make.into({"", {0, 0, 0}, 1}, i % 2 ? 3 : 0.2f));
    return {set};
}
const TestScene kEmptyScene{"an empty scene", nothing, rays_at_nothing};

// Rays at the middles of triangles anywhere in a soup.
std::vector<RaySet> rays_at_soup(const BuildScene& scene, size_t count, uint64_t seed) {
    RayMaker make(10, seed);
    RaySet set{"hits.large", "rays at more than 65536 triangles", {}, false, ""};
    for (size_t i = 0; i < count && !scene.triangles.empty(); ++i) {
        const rt_packed_prim& t = scene.triangles[make.below(scene.triangles.size())];
        Point to, from = make.direction();
        for (int k = 0; k < 3; ++k) {
            to[k] = (t.a[k] + t.b[k] + t.c[k]) / 3;
            from[k] = to[k] - (i % 4 ? 0.5f : 120) * from[k];
        }
        set.rays.push_back(RayMaker::from_to(from, to));
    }
    return {set};
}
const TestScene kLargeScene{"70000 triangles", [](uint64_t seed) { return soup_scene(kLarge, seed); }, rays_at_soup},
    kHugeScene{"more than 2^20 triangles", [](uint64_t seed) { return soup_scene(kHuge, seed); }, rays_at_soup, nullptr, 120};

}  // namespace

std::vector<Check> built_checks(const BenchInput& input) {
    std::vector<Check> checks = {
        {"hits.parameters", "rays with all parameters at the ends of their ranges, and in between",
         [=](const Step& step) { return parameters(input, step); }},
        {"hits.pack", "rays in trees of other builders, packed", [=](const Step& step) { return packed(input, step); }},
    };
    BenchInput debug = input;  // other programs are those of the other checks
    debug.options.quick = true;
    const bool refits = refit_of(input.layout ? *input.layout : input.plugin).refit != nullptr;
    checks.push_back({"hits.refit", "rays in scenes that moved after the build", [=](const Step& step) {
                          return refits ? refitted(debug, input.options.quick, step)
                                        : Outcome::skipped("the plugin does not offer `refit`");
                      }});
    // Their programs are their own, because they have no instances: quick checks compile those of one lane.
    const auto add = [&](const TestScene& test) {
        const auto bench = std::make_shared<Bench>(few(input), test);
        const RaySet set = test.rays(BuildScene(), 0, 0).front();
        checks.push_back({set.name, set.tried, [=](const Step& step) {
                              if (input.options.quick) bench->take_turn(0, step);
                              return trace_set(*bench, set.name, step);
                          }});
    };
    add(kEmptyScene);
    add(input.options.large ? kHugeScene : kLargeScene);
    return checks;
}

}  // namespace clarity::check
