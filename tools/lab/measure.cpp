#include "tools/lab/measure.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "base/error.hpp"
#include "device/device.hpp"
#include "plugin/registry.hpp"
#include "rt_plugin.h"
#include "tools/bench/run/measure.hpp"
#include "tools/check/builds/build_run.hpp"
#include "tools/check/hits/checked_scene.hpp"
#include "tools/check/hits/judge.hpp"
#include "tools/lab/lab.hpp"
#include "tools/lab/measure_materials.hpp"
#include "worker/child.hpp"

namespace clarity::lab {
namespace {

using check::CheckedScene;
using check::Variant;

// What it costs to follow a scene that moves: which nodes of a pose's tree were there in the pose before.

// What a builder of trees did for all poses of a case. Pose k is the mesh k.
struct MotionCosts {
    double nodes = 0;   // of all trees; each got a box for its pose
    double fresh = 0;   // of these, those that the tree of the pose before does not have
    double sorted = 0;  // primitives below each of them
};

// Tells sets of primitives apart, whatever their order: a sum of numbers that look random (the finalizer of Steele, Lea, Flood
// 2014, "Fast Splittable Pseudorandom Number Generators").
uint64_t mixed(uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

struct Below {
    uint64_t set = 0;
    double count = 0;
};

// The nodes of a tree, each as one number: of the primitives below it, and of how its children share them.
class TreeNodes {
 public:
    TreeNodes(const BuilderResult& result, rt_u32 root, rt_u32 first_ref)
        : nodes_(reinterpret_cast<const rt_topology_node*>(result.slots[0].memory.data())),
          refs_(reinterpret_cast<const rt_u32*>(result.refs.data())),
          first_ref_(first_ref) {
        if (root != RT_NONE) visit(root);
    }
    std::vector<std::pair<uint64_t, double>> all;  // node, primitives below it

 private:
    // Trees are at most RT_TOPOLOGY_DEPTH deep: BuildCase has checked it.
    Below visit(rt_u32 at) {
        const rt_topology_node& node = nodes_[at];
        Below below;
        uint64_t shares = 0;
        if (node.right & RT_TOPOLOGY_LEAF) {
            for (rt_u32 i = 0; i < (node.right & ~RT_TOPOLOGY_LEAF); ++i)
                below.set += mixed(RT_REF_INDEX(refs_[node.left + i]) - first_ref_), below.count += 1;
        } else {
            const Below left = visit(node.left), right = visit(node.right);
            below = {left.set + right.set, left.count + right.count};
            shares = mixed(left.set) + mixed(right.set);
        }
        all.emplace_back(mixed(below.set) ^ shares, below.count);
        return below;
    }

    const rt_topology_node* nodes_;
    const rt_u32* refs_;
    const rt_u32 first_ref_;
};

// Builds the trees of a case by `plugin`, which builds topologies, and compares each with that of the pose before. What a node
// is decides, and not what the builder says: the primitives below it, and how its children share them. Throws Error.
MotionCosts motion_costs(const rt_plugin& plugin, const Scene& scene) {
    const check::BuildCase input("the poses", scene);
    const BuildScene& build = input.scene();
    const check::BuildRun run = input.run(plugin, {}, check::Schedule::program);
    if (run.why) throw Error(Exit::failed, run.why.text()).as(run.why.failure());
    MotionCosts costs;
    std::set<uint64_t> before;
    for (const rt_u32 group : build.group_of_mesh) {
        const TreeNodes tree(run.result, run.result.roots[group], build.first_ref_of_group[group]);
        std::set<uint64_t> now;
        for (const auto& [node, count] : tree.all) {
            now.insert(node);
            if (before.count(node)) continue;
            costs.fresh += 1, costs.sorted += count;
        }
        costs.nodes += double(tree.all.size());
        before = std::move(now);
    }
    return costs;
}

constexpr uint64_t kMemoryBytes = uint64_t(4) << 30;
constexpr size_t kJudged = 600;     // rays of a case that are compared with every primitive
constexpr double kCompile_s = 120;  // processor time of the first launch, which compiles
constexpr double kTimes_s = 3;      // for the times of a case
// Of a ray and a box, see work_of(). A primitive that is sorted into a child costs a builder as much, and so does a box that is
// fitted: these are the same six numbers.
constexpr double kBoxWork = 0.2;

const rt_plugin* open_library(const std::string& path) {
    if (path.empty()) return nullptr;
    const PluginRecord record = load_plugin(path);
    if (!record.plugin || !record.plugin->accel) throw Error(Exit::failed, path + ": is no structure: " + record.why);
    return record.plugin;
}

// Of a structure, rays with counts. With one lane each ray has its own.
struct Counted {
    std::vector<rt_hit> hits;
    RayCosts costs;
};
Counted count(CheckedScene& scene, const Variant& variant, const std::vector<rt_ray>& rays, rt_u32 node_bytes) {
    Counted counted;
    std::vector<RayWork> work;
    RayQuery query;
    query.count = true;
    query.work = &work;
    counted.hits = scene.trace(*scene.prepared(variant), rays, query).hits;
    RayCosts& costs = counted.costs;
    costs.node_bytes = node_bytes;
    bool own_boxes = false;
    for (size_t i = 0; i < counted.hits.size(); i += static_cast<size_t>(variant.lanes)) {
        // What a structure says of itself is no count.
        if (work[i].own_steps > 0 || work[i].own_tests > 0)
            throw Error(Exit::failed,
                        "its nodes or tests are not counted by the host: read nodes by RT_NODE, and test primitives by "
                        "RT_LEAF (cl/CONTRACT.md, \"Counting\")");
        own_boxes |= work[i].own_boxes > 0;
        costs.nodes += counted.hits[i].steps, costs.boxes += work[i].boxes, costs.tests += counted.hits[i].leaf_tests;
    }
    // Boxes that nobody counts would be free. Also a grid has one: its own.
    if (own_boxes || costs.boxes == 0)
        throw Error(Exit::failed, std::string(own_boxes ? "it tests boxes by arithmetic of its own"
                                                        : "the host has counted 0 boxes, so it tests them by arithmetic of its "
                                                          "own, or none") +
                                      ": test each by rt_enter_box, rt_enter_exit, rt_enter_bounds or rt_enter_planes, which "
                                      "count it (cl/CONTRACT.md, \"Counting\")");
    for (double* const sum : {&costs.nodes, &costs.boxes, &costs.tests}) *sum /= double(rays.size());
    return counted;
}

// Says what is wrong with the first rays, if anything is.
void judge(CheckedScene& scene, const Variant& variant, std::vector<rt_ray> rays, std::vector<rt_hit> nearest,
           nlohmann::json& report) {
    // Every k-th one, so that all kinds are among them.
    const size_t step = (rays.size() + kJudged - 1) / kJudged;
    for (size_t i = 0; i * step < rays.size(); ++i) rays[i] = rays[i * step], nearest[i] = nearest[i * step];
    rays.resize((rays.size() + step - 1) / step), nearest.resize(rays.size());
    const std::vector<check::Truth> truths = check::BruteForce(scene.build_scene()).trace(rays);
    const std::vector<rt_hit> any = scene.trace(variant, rays, true).hits;
    for (const bool any_hit : {false, true}) {
        const std::vector<rt_hit>& hits = any_hit ? any : nearest;
        const check::Faults faults = check::Faults::of(rays, truths, hits, any_hit);
        if (faults.wrong.empty()) continue;
        report["wrong"] =
            std::string(any_hit ? "any-hit queries" : "nearest hits") + ": " + faults.text(rays, truths, hits, variant.lanes);
        report["kind"] = any_hit ? Wrong::any_hits : Wrong::nearest_hits;
        return;
    }
}

void report_case(const nlohmann::json& report) {
    worker::send_message(worker::kChannelFd, {worker::MessageKind::report, 0, 0,
                                              report.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)});
}

// "30.42 nodes of 64 bytes, 60.85 boxes and 5.84 tests a ray"
std::string text_of(const RayCosts& costs, bool moves) {
    char text[240];
    int length = std::snprintf(text, sizeof text, "%.2f nodes of %.3g bytes, %.2f boxes and %.2f tests a ray", costs.nodes,
                               costs.node_bytes, costs.boxes, costs.tests);
    if (moves)
        std::snprintf(
            text + length, sizeof text - size_t(length),
            "; from pose to pose %.0f %% of the nodes are new, and building and fitting adds %.2f to the work of a ray",
            100 * costs.fresh, costs.following);
    return text;
}

void measure_job(ParcelReader& arguments) {
    auto job = worker::arguments_in<MeasureJob>(arguments);
    if (!job.materials.empty()) {
        measure_materials(job, report_case);
        return;
    }
    const rt_plugin *layout = open_library(job.layout), *reference = open_library(job.reference),
                    *student = job.closed.empty() ? open_library(job.library) : take_closed_builder(job.closed.front());
    worker::enter_sandbox(worker::WorkerKind::driver);
    const auto device = std::make_shared<Device>(choose_device(job.device));
    const Variant variant = Variant::plain(job.lanes);
    const auto layout_for = [&](const rt_plugin& plugin) { return plugin.accel->topology ? layout : nullptr; };
    const auto node_bytes = [&](const rt_plugin& plugin) {
        return (plugin.accel->topology ? layout : &plugin)->accel->slots[0].elem_bytes;
    };
    for (size_t c = 0; c < job.scenes.size(); ++c) {
        const std::vector<rt_ray>& rays = job.rays[c];
        const auto costs_of = [&](const rt_plugin& plugin, RayCosts costs) {
            if (job.poses[c] > 1) {
                const MotionCosts motion = motion_costs(plugin, job.scenes[c].scene);
                costs.following = kBoxWork * (motion.nodes + motion.sorted) / double(rays.size());
                costs.fresh = motion.fresh / std::max(motion.nodes, 1.0);
            }
            return costs;
        };
        // Each pose is a group of its own; a scene that was sent does not say so.
        if (job.poses[c] > 1)
            for (Instance& instance : job.scenes[c].scene.instances) instance.apart = true;
        nlohmann::json report;
        std::unique_ptr<CheckedScene> theirs;
        double reference_work = 0;
        if (reference) {
            worker::say_step("tracing the reference", kCompile_s);
            theirs = std::make_unique<CheckedScene>(*reference, layout_for(*reference), job.scenes[c].scene, device);
            reference_work = work_of(costs_of(*reference, count(*theirs, variant, rays, node_bytes(*reference)).costs));
        }
        report["reference_work"] = reference_work;
        Wrong stage = Wrong::build;
        try {
            // The library's own limit of time is that of its builds.
            worker::say_step("building", kCompile_s);
            CheckedScene own(*student, layout_for(*student), job.scenes[c].scene, device);
            stage = Wrong::kernels;
            worker::say_step("compiling", kCompile_s);
            own.compile(variant);
            own.count(variant, {rays.front()}, false);
            stage = Wrong::counts;
            worker::say_step("tracing " + std::to_string(rays.size()) + " rays", job.limit_s);
            Counted counted = count(own, variant, rays, node_bytes(*student));
            worker::say_step("comparing hits", 60 + job.limit_s);
            judge(own, variant, rays, std::move(counted.hits), report);
            stage = Wrong::build;
            const RayCosts costs = costs_of(*student, counted.costs);
            report["found"] = text_of(costs, job.poses[c] > 1), report["work"] = work_of(costs);
            if (job.times && theirs && !report.contains("wrong")) {
                worker::say_step("measuring times", 20 * kTimes_s);
                const RayBlocks blocks(rays, static_cast<unsigned>(job.lanes));
                RayQueries own_queries(device), their_queries(device);
                const auto contender = [&](const char* name, RayQueries& queries, CheckedScene& scene) {
                    return bench::Contender{name, [&queries, &blocks, prepared = scene.prepared(variant)] {
                                                RayQuery query;
                                                query.brief = true;
                                                bench::Sample sample;
                                                sample.time_ms = sample.wall_ms = queries.trace(*prepared, blocks, query);
                                                const RayTuning tuning = queries.tuning();
                                                sample.trial = tuning.trial, sample.settled = tuning.settled;
                                                sample.variant = tuning.variant;
                                                return sample;
                                            }};
                };
                bench::MeasureRules rules;
                rules.budget_s = kTimes_s;
                Progress progress;
                const std::vector<bench::Measured> measured = bench::measure_interleaved(
                    {contender("reference", their_queries, *theirs), contender("submission", own_queries, own)}, rules,
                    progress);
                // The least of each: on a busy machine medians are of the others' work.
                report["reference_ms"] = measured[0].time_ms.min, report["ms"] = measured[1].time_ms.min;
                report["steady"] = measured[0].status == bench::RowStatus::ok && measured[1].status == bench::RowStatus::ok;
            }
        } catch (const Error& e) {
            report["wrong"] = e.what(), report["kind"] = wrong_of(e.failure(), stage);
        }
        report_case(report);
    }
}

class Run : public worker::Job {
 public:
    explicit Run(double limit_s) : Job(kMeasureJob, "the structure", {limit_s, 0, kMemoryBytes}) {}
    std::vector<CaseFigures> cases;

 private:
    void on_output(const std::string&) override {}  // of a kernel's printf, too
    void on_report(const std::string& text) override {
        CaseFigures figures;
        try {
            const nlohmann::json json = nlohmann::json::parse(text);
            figures.wrong = json.value("wrong", "");
            figures.kind = static_cast<Wrong>(std::clamp(json.value("kind", 0), 0, static_cast<int>(Wrong::other)));
            figures.found = json.value("found", "");
            figures.work = json.value("work", 0.0), figures.truth = json.value("truth", std::vector<double>{});
            figures.reference_work = json.value("reference_work", 0.0);
            figures.ms = json.value("ms", 0.0), figures.reference_ms = json.value("reference_ms", 0.0);
            figures.steady = json.value("steady", true);
        } catch (const nlohmann::json::exception&) {  // the worker's memory may be damaged
            throw Error(Exit::failed, "what was measured cannot be read");
        }
        cases.push_back(std::move(figures));
    }
};

}  // namespace

// Our estimates, in tests of a triangle. A box: by the operations, of which a slab test has 6 products and 7 choices, about a
// fifth of a triangle's (cl/lanes/rays.h, cl/primitives/triangle.h). A node: what its line of memory costs, which is most of
// the rest of a step, so that a node of 64 bytes with two boxes is 0.8 + 2 * 0.2 = 1.2 tests. Larger nodes are more lines, and
// cost in proportion. They are not fitted to times: those depend on the machine, and have points of their own.
double work_of(const RayCosts& costs) {
    constexpr double kLine = 0.8, kTest = 1, kLineBytes = 64;
    return costs.nodes * kLine * std::max(1.0, costs.node_bytes / kLineBytes) + costs.boxes * kBoxWork + costs.tests * kTest +
           costs.following;
}

Wrong wrong_of(Failure failure, Wrong otherwise) {
    switch (failure) {
        case Failure::no_memory:
            return Wrong::memory;
        case Failure::keeps_state:
            return Wrong::state;
        case Failure::crash:
            return Wrong::crash;
        case Failure::exit:
            return Wrong::exit;
        case Failure::endless:
            return Wrong::endless;
        default:
            return otherwise;
    }
}

std::vector<CaseFigures> measure(const MeasureJob& job, Progress& progress) {
    Run run(job.limit_s);
    run.subject = job.library;
    std::string died = "nothing was measured";
    Wrong kind = Wrong::other;
    try {
        run.run(job, progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        died = e.what(), kind = wrong_of(e.failure(), Wrong::other);
    }
    while (run.cases.size() < job.scenes.size() + job.materials.size()) {
        run.cases.emplace_back();
        run.cases.back().wrong = died, run.cases.back().kind = kind;
    }
    return run.cases;
}

const worker::JobKind kMeasureJob = {
    "lab",
    "to see what a lab measures, run `clarity lab check`",
    Exit::failed,
    true,
    LogLevel::debug,
    {"it crashed ({how}) while {step}", "it ended the process ({how}) while {step}",
     "it did not come to its end within {how} while {step}: a loop without end", "it was killed while {step}",
     "it needs more than {how} of memory while {step}", "it was killed while {step}"},
    measure_job};

}  // namespace clarity::lab
