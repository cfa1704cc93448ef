#include "tools/check/builds/refit_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include "plugin/capabilities.hpp"
#include "tools/check/builds/parameter_tries.hpp"
#include "tools/check/builds/refit_run.hpp"
#include "tools/check/builds/result_checks.hpp"
#include "tools/check/scenes.hpp"

namespace clarity::check {
namespace {

constexpr double kRefitLimit_s = 20;

// Calls move(p) for each vertex, in the space of its mesh.
template <class Move>
Scene each_vertex(Scene scene, Move&& move) {
    std::vector<float>& positions = scene.positions.own();
    for (size_t v = 0; v + 2 < positions.size(); v += 3) move(&positions[v]);
    return scene;
}

Scene at_rest(Scene scene) {
    return scene;
}
Scene as_wave(Scene scene) {
    return each_vertex(std::move(scene), [](float* p) {
        const float x = p[0], y = p[1], z = p[2];
        p[0] += 0.3f * std::sin(2 * y + z);
        p[1] += 0.4f * std::sin(3 * z + x);
        p[2] += 0.3f * std::sin(x - 2 * y);
    });
}
Scene twisted(Scene scene) {
    return each_vertex(std::move(scene), [](float* p) {
        const float angle = 0.2f * p[1], c = std::cos(angle), s = std::sin(angle), x = p[0], z = p[2];
        p[0] = c * x + s * z;
        p[2] = c * z - s * x;
    });
}
// Triangles fly apart, and instances change places.
Scene scattered(Scene scene) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> any(-40, 40);
    std::vector<float>& positions = scene.positions.own();
    for (size_t t = 0; t + 2 < scene.triangles.size(); t += 3) {
        const float by[3] = {any(random), any(random), any(random)};
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < 3; ++k) positions[3 * size_t(scene.triangles[t + c]) + k] += by[k];
    }
    for (Instance& instance : scene.instances)
        for (int k = 0; k < 3; ++k) instance.world_from_object[4 * k + 3] += any(random);
    return scene;
}
Scene in_plane(Scene scene) {
    return each_vertex(std::move(scene), [](float* p) { p[1] = 3.25f; });
}
Scene at_point(Scene scene) {
    return each_vertex(std::move(scene), [](float* p) {
        p[0] = 0.1f;
        p[1] = -7.3f;
        p[2] = 1e-3f;
    });
}
Scene grown(Scene scene) {
    return each_vertex(std::move(scene), [](float* p) {
        for (int k = 0; k < 3; ++k) p[k] *= 1e6f;
    });
}

std::vector<uint8_t> all_groups(const BuildCase& input) {
    return std::vector<uint8_t>(input.scene().groups.size(), 1);
}

class RefitCheck {
 public:
    RefitCheck(const rt_plugin& plugin, bool quick) : plugin_(plugin), params_(default_parameters(plugin)), quick_(quick) {}

    Outcome run(const Step& step) {
        if (!refit_of(plugin_).refit) return Outcome::skipped("the plugin does not offer `refit`");
        unsigned refits = 0;
        std::vector<NamedScene> scenes = small_scenes();
        scenes.push_back({"sparse", sparse_scene(300)});
        for (const NamedScene& scene : scenes)
            for (const Movement& movement : movements()) {
                // A look at all volumes of the large scene takes long: the small ones say the same, but for its groups.
                const bool large = scene.name == "mixed";
                if (large && quick_ && movement.move != as_wave) continue;
                const std::string what = "scene `" + scene.name + "`, " + movement.name;
                step("refitting " + what, kRefitLimit_s);
                if (const Problem why = fault(scene, movement, params_)) return Outcome::failed(what, why);
                ++refits;
            }
        // Each choice may have volumes of its own.
        const NamedScene& small = scenes.back();
        for (const ParameterValues& params : parameter_tries(plugin_, 0))
            for (const Movement& movement : movements()) {
                if (movement.move != as_wave && movement.move != at_point && quick_) continue;
                const std::string what =
                    "with " + choice_text(plugin_, params) + ", scene `" + small.name + "`, " + movement.name;
                step("refitting " + what, kRefitLimit_s);
                if (const Problem why = fault(small, movement, params)) return Outcome::failed(what, why);
                ++refits;
            }
        for (const NamedScene& scene : scenes) {
            step("refitting single groups of scene `" + scene.name + "`", kRefitLimit_s);
            if (const Problem why = trespass(scene)) return Outcome::failed("scene `" + scene.name + "`: " + why.text());
        }
        step("comparing the costs of refits with the trees' boxes", kRefitLimit_s);
        if (const Problem why = costs_of_mixed()) return Outcome::failed(why.text());
        step("refitting many triangles", kRefitLimit_s);
        if (const Problem why = thread_fault()) return Outcome::failed("scene `many`: " + why.text());
        return Outcome::passed(std::to_string(refits) + " refits hold every primitive and touch nothing else");
    }

 private:
    static Problem failure_of(const RefitRun& run) {
        return run.cancelled ? "said that it was cancelled, but nobody had cancelled it" : run.why;
    }

    // Builds a scene, moves it, refits it, and looks at the volumes.
    Problem fault(const NamedScene& scene, const Movement& movement, const ParameterValues& params) {
        const BuildCase rest(scene.name, scene.scene), moved(scene.name, movement.move(scene.scene));
        if (moved.scene().prims.size() != rest.scene().prims.size()) return {};  // flattened in another way
        const BuildRun built = rest.run(plugin_, params, Schedule::program);
        if (built.why) return built.why;
        RefitRun run = run_refit(plugin_, params, built.result, moved.scene(), all_groups(rest), Schedule::program);
        if (const Problem why = failure_of(run)) return why;
        if (!plugin_.accel->levels) return {};
        Problem why = loose_bounds(plugin_, moved.scene(), run.result);
        return why ? Problem("after the refit " + why.text()) : Problem();
    }

    // A refit of one group writes nothing that belongs to another, and a refit of none writes nothing.
    Problem trespass(const NamedScene& scene) {
        const BuildCase rest(scene.name, scene.scene), moved(scene.name, scattered(scene.scene));
        const BuildRun built = rest.run(plugin_, params_, Schedule::program);
        if (built.why) return built.why;
        const auto group_count = static_cast<rt_u32>(rest.scene().groups.size());
        std::vector<std::vector<rt_u32>> writer(built.result.slots.size());  // for each byte: the group that wrote it
        for (size_t s = 0; s < writer.size(); ++s) writer[s].assign(built.result.slots[s].memory.bytes(), RT_NONE);
        for (rt_u32 g = 0; g <= group_count; ++g) {
            std::vector<uint8_t> changed(group_count, 0);
            if (g < group_count) changed[g] = 1;
            const RefitRun run = run_refit(plugin_, params_, built.result, moved.scene(), changed, Schedule::forward);
            if (const Problem why = failure_of(run)) return why;
            for (size_t s = 0; s < writer.size(); ++s) {
                const auto *before = static_cast<const unsigned char*>(built.result.slots[s].memory.data()),
                           *after = static_cast<const unsigned char*>(run.result.slots[s].memory.data());
                const rt_slot& slot = plugin_.accel->slots[s];
                for (size_t i = 0; i < writer[s].size(); ++i) {
                    if (before[i] == after[i]) continue;
                    const std::string where = std::string("slot ") + slot.name + ", element " +
                                              std::to_string(i / slot.elem_bytes) + ", byte " +
                                              std::to_string(i % slot.elem_bytes);
                    if (g == group_count) return "no group is changed, but the refit wrote to " + where;
                    if (writer[s][i] != RT_NONE)
                        return "refits of group " + std::to_string(writer[s][i]) + " and of group " + std::to_string(g) +
                               " both wrote to " + where + ": one of them wrote outside of its group";
                    writer[s][i] = g;
                }
            }
        }
        return {};
    }

    Problem costs_of_mixed() {
        if (!plugin_.accel->levels) return {};
        const Scene scene = mixed_scene();
        const BuildCase rest("mixed", scene);
        const BuildRun built = rest.run(plugin_, params_, Schedule::program);
        if (built.why) return built.why;
        std::vector<PosedCosts> poses;
        for (const Movement& movement : movements()) {
            if (movement.is_flat) continue;
            const BuildCase moved("mixed", movement.move(scene));
            if (moved.scene().prims.size() != rest.scene().prims.size()) continue;
            const RefitRun run = run_refit(plugin_, params_, built.result, moved.scene(), all_groups(rest), Schedule::program);
            if (const Problem why = failure_of(run)) return why;
            poses.push_back({movement.name, run.costs, relative_surfaces(plugin_, run.result)});
        }
        return cost_fault(rest.scene(), poses);
    }

    // Many triangles: the same bytes with any threads, and again from a tree that was refitted before; cancelling.
    Problem thread_fault() {
        const Scene scene = soup_scene(quick_ ? 12000 : 70000);
        const BuildCase rest("many", scene), first("many", scattered(scene)), second("many", as_wave(scene));
        const BuildRun built = rest.run(plugin_, params_, Schedule::program);
        if (built.why) return built.why;
        const auto groups = all_groups(rest);
        const RefitRun one = run_refit(plugin_, params_, built.result, second.scene(), groups, Schedule::forward);
        if (const Problem why = failure_of(one)) return why;
        for (const Schedule schedule : {Schedule::backward, Schedule::shuffled2, Schedule::shuffled7, Schedule::program}) {
            const RefitRun run = run_refit(plugin_, params_, built.result, second.scene(), groups, schedule);
            Problem why = failure_of(run);
            if (!why) why = difference(one.result, run.result, *plugin_.accel);
            if (why)
                return std::string("the result ") + schedule_text(schedule) + " is another than with one thread: " + why.text();
        }
        const RefitRun between = run_refit(plugin_, params_, built.result, first.scene(), groups, Schedule::program);
        if (const Problem why = failure_of(between)) return why;
        const RefitRun again = run_refit(plugin_, params_, between.result, second.scene(), groups, Schedule::program);
        if (const Problem why = failure_of(again)) return why;
        if (const Problem why = difference(one.result, again.result, *plugin_.accel))
            return "a refit depends on the pose before: " + why.text() + " after another refit";
        if (one.reports < 2) return {};
        const RefitRun stopped = run_refit(plugin_, params_, built.result, second.scene(), groups, Schedule::program, 1);
        if (!stopped.cancelled)
            return "host->progress returned 0 at the first report of " + std::to_string(one.reports) +
                   ", and the refit went on to the end: it must return RT_CANCELLED soon";
        return {};
    }

    const rt_plugin& plugin_;
    const ParameterValues params_;
    const bool quick_;
};

}  // namespace

const std::vector<Movement>& movements() {
    static const std::vector<Movement> all = {{"at rest", at_rest},
                                              {"as a wave", as_wave},
                                              {"twisted", twisted},
                                              {"scattered", scattered},
                                              {"in one plane", in_plane, true},
                                              {"at one point", at_point, true},
                                              {"a million times as large", grown}};
    return all;
}

Check refit_check(const rt_plugin& plugin, bool quick) {
    const auto check = std::make_shared<RefitCheck>(plugin, quick);
    return {"builds.refit", "`refit` follows primitives that moved, and writes nothing else",
            [=](const Step& step) { return check->run(step); }};
}

}  // namespace clarity::check
