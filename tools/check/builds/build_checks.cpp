#include "tools/check/builds/build_checks.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

#include "tools/check/builds/build_run.hpp"
#include "tools/check/builds/pack_checks.hpp"
#include "tools/check/builds/parameter_tries.hpp"
#include "tools/check/builds/refit_checks.hpp"
#include "tools/check/builds/result_checks.hpp"
#include "tools/check/process_size.hpp"
#include "tools/check/scenes.hpp"

namespace clarity::check {
namespace {

constexpr double kBuildLimit_s = 10;  // a build of a small scene that lasts longer counts as endless
constexpr double kManyLimit_s = 30;   // the same for the many triangles
constexpr unsigned kManyTriangles = 70000, kLargeTriangles = (1u << 20) + 4099;  // above 2^16, and above 2^20
constexpr double kPatience_ms = 500;  // a build that lasts longer must ask whether it is cancelled

// The inputs, made on first use and shared by all checks of a structure.
class Inputs {
 public:
    Inputs(const rt_plugin& p, uint64_t s) : plugin(p), seed(s), params(default_parameters(p)) {}
    const rt_plugin& plugin;
    const uint64_t seed;  // of random numbers
    bool large = false;
    const ParameterValues params;

    const std::vector<BuildCase>& small() {
        if (small_.empty())
            for (NamedScene& scene : small_scenes(seed)) small_.emplace_back(scene.name, scene.scene);
        return small_;
    }
    const BuildCase& mixed() { return small().back(); }
    const BuildCase& sparse() {
        return lazy(sparse_, "sparse", [this] { return sparse_scene(700, seed); });
    }
    const BuildCase& many() {
        return lazy(many_, "many", [this] { return soup_scene(large ? kLargeTriangles : kManyTriangles, seed); });
    }
    BuildRun run(const BuildCase& input, Schedule schedule = Schedule::program) const {
        return input.run(plugin, params, schedule);
    }

 private:
    template <class Make>
    static const BuildCase& lazy(std::unique_ptr<BuildCase>& input, const char* name, Make make) {
        if (!input) input = std::make_unique<BuildCase>(name, make());
        return *input;
    }
    std::vector<BuildCase> small_;
    std::unique_ptr<BuildCase> sparse_, many_;
};

std::string on(const BuildCase& input) {
    return "scene `" + input.name() + "` (" + std::to_string(input.scene().prims.size()) + " primitives)";
}

// How a run failed that nobody cancelled.
Problem failure_of(const BuildRun& run) {
    return run.cancelled ? "said that it was cancelled, but nobody had cancelled it" : run.why;
}

Outcome sound(Inputs& inputs, const Step& step) {
    for (const BuildCase& input : inputs.small()) {
        step("building " + on(input), kBuildLimit_s);
        const BuildRun run = inputs.run(input);
        if (const Problem why = failure_of(run)) return Outcome::failed(on(input), why);
        for (const auto& [label, value] : run.result.stats)
            if (!std::isfinite(value)) return Outcome::failed(on(input) + ": the statistic `" + label + "` is no number");
    }
    return Outcome::passed(std::to_string(inputs.small().size()) + " scenes built");
}

Outcome refs(Inputs& inputs, const Step& step) {
    uint64_t count = 0;
    for (const BuildCase& input : inputs.small()) {
        step("building " + on(input), kBuildLimit_s);
        const BuildRun run = inputs.run(input);
        if (const Problem why = failure_of(run)) return Outcome::failed(on(input), why);
        if (const Problem why = missing_refs(input.scene(), run.result)) return Outcome::failed(on(input), why);
        count += input.scene().prims.size();
    }
    return Outcome::passed("all of " + std::to_string(count) + " are there");
}

Outcome bounds(Inputs& inputs, const Step& step) {
    if (!inputs.plugin.accel->levels) return Outcome::skipped("the plugin has no `levels`");
    for (const BuildCase* input : {&inputs.sparse(), &inputs.mixed()}) {
        step("building " + on(*input), kBuildLimit_s);
        BuildRun run = inputs.run(*input);
        if (const Problem why = failure_of(run)) return Outcome::failed(on(*input), why);
        step("asking for the levels of " + on(*input), kBuildLimit_s);
        if (const Problem why = loose_bounds(inputs.plugin, input->scene(), run.result))
            return Outcome::failed(on(*input), why);
    }
    return Outcome::passed("every corner of every triangle is in a volume of each level");
}

Outcome threads(Inputs& inputs, const Step& step, bool quick) {
    std::vector<Schedule> schedules = {Schedule::backward, Schedule::shuffled2, Schedule::shuffled7, Schedule::program};
    const int rounds = quick || inputs.large ? 2 : 8;
    for (const BuildCase* input : {&inputs.mixed(), &inputs.many()}) {
        step("building " + on(*input) + " with one thread", kManyLimit_s);
        const BuildRun first = inputs.run(*input, Schedule::forward);
        if (const Problem why = failure_of(first)) return Outcome::failed(on(*input), why);
        for (int round = 0; round < rounds; ++round)
            for (const Schedule schedule : schedules) {
                step("building " + on(*input) + " " + schedule_text(schedule), kManyLimit_s);
                const BuildRun run = inputs.run(*input, schedule);
                if (const Problem why = failure_of(run))
                    return Outcome::failed(on(*input) + " " + schedule_text(schedule), why);
                Problem why = difference(first.result, run.result, built_slots(inputs.plugin));
                if (why)
                    return Outcome::failed(
                        on(*input) + ": the result " + schedule_text(schedule) + " is another than with one thread: " +
                        why.text() + ". Bodies of parallel_for depend on their order, or write to the same memory (a race)");
            }
    }
    return Outcome::passed("the same bytes with 1, 2 and 7 threads, in " + std::to_string(rounds) + " rounds");
}

// Two builds at a time, and one after another scene: a plugin keeps no state.
Outcome state(Inputs& inputs, const Step& step) {
    const BuildCase &a = inputs.mixed(), &b = inputs.sparse();
    step("building two scenes one after the other", kBuildLimit_s);
    const BuildRun first = inputs.run(a, Schedule::forward), other = inputs.run(b, Schedule::forward),
                   again = inputs.run(a, Schedule::forward);
    for (const BuildRun* run : {&first, &other, &again})
        if (const Problem why = failure_of(*run)) return Outcome::failed(why.text());
    if (const Problem why = difference(first.result, again.result, built_slots(inputs.plugin)))
        return Outcome::failed("the same scene gives another result after a build of another scene: " + why.text() +
                               ". The plugin keeps state");
    step("building two scenes at a time", kBuildLimit_s);
    BuildRun together[2];
    std::thread thread([&] { together[1] = inputs.run(b, Schedule::forward); });
    together[0] = inputs.run(a, Schedule::forward);
    thread.join();
    for (const BuildRun& run : together)
        if (const Problem why = failure_of(run)) return Outcome::failed("two builds at a time: " + why.text());
    for (const auto& [x, y] : {std::pair(&first, &together[0]), std::pair(&other, &together[1])})
        if (const Problem why = difference(x->result, y->result, built_slots(inputs.plugin)))
            return Outcome::failed("two builds at a time disturb each other: " + why.text() + ". The plugin keeps state");
    return Outcome::passed("builds do not depend on what was built before or is built beside");
}

// Cancels a build of one scene. Returns what is wrong. reports: how often the build asks.
Problem cancel_fault(Inputs& inputs, const BuildCase& input, const Step& step, unsigned& reports) {
    step("building " + on(input), kManyLimit_s);
    const BuildRun whole = inputs.run(input);
    reports = whole.reports;
    if (const Problem why = failure_of(whole)) return on(input) + ": " + why.text();
    if (whole.reports == 0)
        return whole.ms < kPatience_ms ? ""
                                       : "a build of " + std::to_string(static_cast<int>(whole.ms)) +
                                             " ms never calls host->progress: nobody can cancel it";
    for (const unsigned at : {1u, (whole.reports + 1) / 2}) {
        step("cancelling at report " + std::to_string(at) + " of " + on(input), kManyLimit_s);
        const BuildRun run = input.run(inputs.plugin, inputs.params, Schedule::program, at);
        if (run.cancelled) continue;
        if (run.why) return "when it is cancelled, it fails instead of returning RT_CANCELLED: " + run.why.text();
        // The last report may come after all work.
        if (at < whole.reports)
            return "host->progress returned 0 at report " + std::to_string(at) + " of " + std::to_string(whole.reports) +
                   ", and it went on to the end: it must return RT_CANCELLED soon";
    }
    step("building " + on(input) + " after a cancel", kManyLimit_s);
    const BuildRun again = inputs.run(input);
    if (const Problem why = failure_of(again)) return "a build after a cancelled one: " + why.text();
    return {};
}

Outcome cancel(Inputs& inputs, const Step& step) {
    unsigned most = 0;
    for (const BuildCase* input : {&inputs.many(), &inputs.mixed()}) {
        unsigned reports = 0;
        if (const Problem why = cancel_fault(inputs, *input, step, reports)) return Outcome::failed(why.text());
        most = std::max(most, reports);
    }
    if (most == 0)
        return Outcome::skipped("it never calls host->progress; a build of " + std::to_string(kManyTriangles) +
                                " triangles is short enough");
    return Outcome::passed("stops when it is told to, and the next build is sound");
}

Outcome parameters(Inputs& inputs, const Step& step, bool quick) {
    const rt_plugin& plugin = inputs.plugin;
    if (plugin.param_count == 0) return Outcome::skipped("the plugin has no parameters");
    const std::vector<ParameterValues> tries = parameter_tries(plugin, inputs.seed);
    std::vector<const BuildCase*> cases;
    if (!quick)
        for (const BuildCase& input : inputs.small()) cases.push_back(&input);
    else
        cases = {&inputs.small()[0], &inputs.small()[1], &inputs.mixed()};
    for (const ParameterValues& params : tries)
        for (const BuildCase* input : cases) {
            const std::string what = choice_text(plugin, params) + " on " + on(*input);
            step("building " + what, kManyLimit_s);
            BuildRun run = input->run(plugin, params, Schedule::program);
            if (const Problem why = failure_of(run)) return Outcome::failed(what, why);
            if (const Problem why = missing_refs(input->scene(), run.result)) return Outcome::failed(what, why);
        }
    return Outcome::passed(std::to_string(tries.size()) + " sets of values at the ends of their ranges and in between");
}

// Other builders' trees: of leaves of one primitive, and of leaves that are larger than any layout has.
Outcome pack(Inputs& inputs, const Step& step) {
    if (!inputs.plugin.accel->pack) return Outcome::skipped("the plugin has no `pack`");
    for (const rt_u32 leaf : {1u, 50u})
        for (const BuildCase& input : inputs.small()) {
            const std::string what = "a tree of leaves of " + std::to_string(leaf) + " over " + on(input);
            step("packing " + what, kBuildLimit_s);
            if (const Problem why = pack_fault(inputs.plugin, input, leaf)) return Outcome::failed(what, why);
        }
    return Outcome::passed("trees of other builders keep every primitive and their bounds");
}

Outcome memory(Inputs& inputs, const Step& step) {
    const BuildCase& input = inputs.many();
    step("building " + on(input), kManyLimit_s);
    const BuildRun run = inputs.run(input);
    if (const Problem why = failure_of(run)) return Outcome::failed(on(input), why);
    Problem why = wasted_memory(built_slots(inputs.plugin), input, run.result);
    if (why) return Outcome::failed(on(input), why);
    return Outcome::passed("slots are as large as what is in them");
}

Outcome leaks(Inputs& inputs, const Step& step, bool quick) {
    const BuildCase& input = inputs.mixed();
    return find_leaks("build", quick ? 40 : 100, [&](unsigned i) {
        if (i % 10 == 0) step("building " + on(input) + " again and again", kManyLimit_s);
        inputs.run(input, i % 2 ? Schedule::program : Schedule::forward);
    });
}

// Memory of a finished build is read-only: a thread that still writes is found.
Outcome afterwards(Inputs& inputs, const Step& step) {
    step("waiting after a build for threads that still write", kBuildLimit_s);
    BuildRun run = inputs.run(inputs.mixed());
    if (const Problem why = failure_of(run)) return Outcome::failed(why.text());
    for (BuilderResult::Slot& slot : run.result.slots) slot.memory.make_read_only();
    run.result.refs.make_read_only();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return Outcome::passed("nothing is written after the build");
}

}  // namespace

std::vector<Check> build_checks(const rt_plugin& plugin, bool quick, uint64_t seed, bool large) {
    const auto inputs = std::make_shared<Inputs>(plugin, seed);
    inputs->large = large;
    return {
        {"builds.sound", "builds scenes from nothing to 3000 primitives, in memory whose overrun is seen",
         [=](const Step& step) { return sound(*inputs, step); }},
        {"builds.refs", "every primitive of the input is in a leaf", [=](const Step& step) { return refs(*inputs, step); }},
        {"builds.bounds", "the volumes that `levels` shows hold the triangles below them",
         [=](const Step& step) { return bounds(*inputs, step); }},
        {"builds.threads", "the same result whatever the number and the order of threads",
         [=](const Step& step) { return threads(*inputs, step, quick); }},
        {"builds.state", "no state is kept from build to build", [=](const Step& step) { return state(*inputs, step); }},
        {"builds.cancel", "a build stops when the user cancels it", [=](const Step& step) { return cancel(*inputs, step); }},
        {"builds.parameters", "builds with all parameters at the ends of their ranges",
         [=](const Step& step) { return parameters(*inputs, step, quick); }},
        {"builds.pack", "packs trees of other builders", [=](const Step& step) { return pack(*inputs, step); }},
        refit_check(plugin, quick),
        {"builds.memory", "slots are not larger than what is in them", [=](const Step& step) { return memory(*inputs, step); }},
        {"builds.leaks", "no memory, file or thread is left behind by build after build",
         [=](const Step& step) { return leaks(*inputs, step, quick); }},
        {"builds.afterwards", "nothing is written after `build` has returned",
         [=](const Step& step) { return afterwards(*inputs, step); }},
    };
}

}  // namespace clarity::check
