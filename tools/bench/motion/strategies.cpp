#include <algorithm>
#include <chrono>
#include <limits>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "launch/prepared.hpp"
#include "moving/follow/pose_follower.hpp"
#include "moving/on_host/host_mover.hpp"
#include "tools/bench/cases/case_run.hpp"
#include "tools/bench/cases/entry.hpp"
#include "tools/bench/output/row.hpp"
#include "tools/bench/run/bench.hpp"
#include "tools/bench/scenes/animations.hpp"
#include "view/view.hpp"

namespace clarity::bench {
namespace {

// A rule, and what it has done so far.
struct Strategy {
    std::string name;
    unsigned every = 0;  // frames from one build to the next; 0: never after the first
    bool is_policy = false;
    PoseFollower follower;
    std::shared_ptr<const AccelData> accel;
    double update_ms = 0, trace_ms = 0, last_trace_ms = 0;
    std::vector<double> frames_ms;
    unsigned builds = 0;
    double worst_cost_ratio = 1;
};

class StrategiesCase : CaseRun {
 public:
    explicit StrategiesCase(const CaseRun& run)
        : CaseRun(run),
          settings_(variant_settings(plugins, request, definition.variants.front())),
          plugin_(*plugins.accel(settings_.accel)),
          preparer_(plugins, {fixture.opened(0)}),
          frames_({fixture.opened(0)}) {}

    std::vector<BenchRecord> run() {
        rest_ = std::make_shared<const Scene>(staged(*fixture.scene(), definition.motion));
        strategies_.resize(8);
        const unsigned every[] = {0, 50, 20, 10, 5, 2, 1};
        for (size_t i = 0; i < 7; ++i) {
            strategies_[i].every = every[i];
            strategies_[i].name = every[i] == 0   ? "always refit"
                                  : every[i] == 1 ? "always build"
                                                  : "build every " + std::to_string(every[i]) + " frames";
        }
        strategies_[7].name = "policy";
        strategies_[7].is_policy = true;
        for (unsigned frame = 0; frame <= kAnimationFrames; ++frame) {
            if (!progress.report(float(frame) / kAnimationFrames)) throw Cancelled();
            const Pose pose = animated_pose(*rest_, definition.motion, frame);
            auto scene = std::make_shared<const Scene>(posed_apart(pose));
            // Frame 0 is built by all of them and does not count. The turns change, because the first to trace a pose finds it
            // colder.
            for (size_t i = 0; i < strategies_.size(); ++i)
                play(strategies_[(i + frame) % strategies_.size()], scene, pose, frame);
        }
        return rows();
    }

 private:
    // What moves is kept apart from the flattened world, as in scenes with clips.
    Scene posed_apart(const Pose& pose) const {
        Scene scene = posed(*rest_, pose);
        for (Instance& instance : scene.instances) instance.apart = true;
        return scene;
    }

    void play(Strategy& s, const std::shared_ptr<const Scene>& scene, const Pose& pose, unsigned frame) {
        using Way = PoseFollower::Way;
        const PosedFrom from = {rest_, definition.motion};
        const Way way = s.is_policy ? Way::automatic : s.every > 0 && frame % s.every == 0 ? Way::build : Way::refit;
        const auto begin = std::chrono::steady_clock::now();
        s.accel.reset();
        s.accel = s.follower.refit(from, scene, pose, way, s.last_trace_ms, progress).accel;
        const bool builds = !s.accel;
        if (builds) {
            s.accel = std::make_shared<const AccelData>(
                build_accel(*scene, plugin_, settings_.accel_params, progress, fixture.target_of(plugin_)));
            s.follower.built(from, scene, pose, s.accel, std::make_unique<HostMover>(scene, s.accel));
        }
        const double update_ms = ms_since(begin);
        const auto prepared = preparer_.prepare(scene, with_optics(settings_, *scene, fixture.view()), progress, s.accel);
        s.last_trace_ms = trace_ms(prepared);
        if (frame == 0) return;
        s.update_ms += update_ms;
        s.trace_ms += s.last_trace_ms;
        s.frames_ms.push_back(update_ms + s.last_trace_ms);
        s.builds += builds;
        if (!s.follower.update().cost_ratios.empty())
            s.worst_cost_ratio = std::max(s.worst_cost_ratio, double(s.follower.update().cost_ratios.back()));
    }

    // Of short frames the least of three times, because a disturbance of the machine is as long as they are.
    double trace_ms(const std::shared_ptr<const MultiPrepared>& prepared) {
        constexpr double kShortMs = 20;
        double least = std::numeric_limits<double>::infinity();
        for (unsigned i = 0; i < 3 && (i == 0 || least < kShortMs); ++i)
            least = std::min(least, frames_.trace(prepared, settings_, fixture.view(), 0, false, progress).device_ms);
        return least;
    }

    std::vector<BenchRecord> rows() {
        double best = std::numeric_limits<double>::infinity();
        for (const Strategy& s : strategies_)
            if (!s.is_policy) best = std::min(best, s.update_ms + s.trace_ms);
        std::vector<BenchRecord> all;
        for (const Strategy& s : strategies_) {
            BenchRecord row = make_row(definition);
            describe(row, *rest_);
            describe(row, fixture.device(0));
            describe(row, settings_);
            describe(row, *s.accel);
            row.variant = s.name;
            row.accel = settings_.accel;
            row.accel_params = parameters_text(plugin_, settings_.accel_params);
            row.time_ms = summarize(s.frames_ms);
            row.animation = {s.update_ms + s.trace_ms,         s.update_ms, s.trace_ms, s.builds, s.worst_cost_ratio,
                             (s.update_ms + s.trace_ms) / best};
            all.push_back(std::move(row));
        }
        return all;
    }

    const Settings settings_;
    const rt_plugin& plugin_;
    MultiPreparer preparer_;
    MultiFrameRenderer frames_;
    std::shared_ptr<const Scene> rest_;
    std::vector<Strategy> strategies_;
};

}  // namespace

std::vector<BenchRecord> measure_strategies(const CaseRun& run) {
    return StrategiesCase(run).run();
}

}  // namespace clarity::bench
