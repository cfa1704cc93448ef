#include <algorithm>
#include <chrono>
#include <cstring>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/parallel_for.hpp"
#include "device/cl_errors.hpp"
#include "launch/prepared.hpp"
#include "moving/on_device/device_mover.hpp"
#include "moving/on_host/host_mover.hpp"
#include "plugin/capabilities.hpp"
#include "tools/bench/baselines/baseline.hpp"
#include "tools/bench/cases/case_run.hpp"
#include "tools/bench/cases/case_state.hpp"
#include "tools/bench/cases/own_entries.hpp"
#include "tools/bench/motion/moving_frames.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/run/bench.hpp"
#include "tools/bench/scenes/animations.hpp"

namespace clarity::bench {
namespace {

// Poses that follow each other again and again. The last one is that of the traced rays.
constexpr double kPhases[] = {0.1, 0.35};

void copy_positions(const float* from, size_t count, float* to) {
    constexpr size_t kPiece = size_t{1} << 16;
    parallel_for(static_cast<uint32_t>((count + kPiece - 1) / kPiece), [&](uint32_t i) {
        std::memcpy(to + i * kPiece, from + i * kPiece, std::min(kPiece, count - i * kPiece) * sizeof(float));
    });
}

class MotionCase : CaseRun {
 public:
    explicit MotionCase(const CaseRun& run) : CaseRun(run), state_(fixture, definition, progress) {}

    std::vector<BenchRecord> run() {
        const Scene& scene = *fixture.scene();
        for (const double phase : kPhases) {
            if (plays()) break;
            poses_.push_back(moved_pose(scene, definition.motion, phase));
            if (definition.measure != "refit") moved_.push_back(std::make_shared<const Scene>(posed(scene, poses_.back())));
        }
        for (const Variant& variant : definition.variants) {
            if (variant.on_device && !moves_on_device(variant)) continue;
            Entry& entry = state_.add_entry();
            run_or_mark_failed(entry, [&](BenchRecord&) { add(variant, entry); });
        }
        for (const std::string& quality : definition.baseline_qualities) add_baseline(quality);
        std::vector<BenchRecord> rows = measured_rows(state_.entries, true, rules, progress);
        compare_with_baselines(rows);
        return rows;
    }

 private:
    // Whether whole frames are shown one after the other, each of which makes its own pose.
    bool plays() const {
        return definition.measure == "frame" || definition.measure == "object" || definition.measure == "clip";
    }
    struct Mover {
        std::shared_ptr<const AccelData> built, now;
        std::unique_ptr<HostMover> accel;
        MovedStructure moved;
        size_t next = 0;
    };

    void add(const Variant& variant, Entry& entry) {
        const Settings settings = variant_settings(plugins, request, variant);
        const rt_plugin& plugin = *plugins.accel(settings.accel);
        BenchRecord& row = entry.row;
        row.variant = variant.label;
        row.accel = settings.accel;
        row.accel_params = parameters_text(plugin, settings.accel_params);
        if (!variant.on_device && (definition.measure == "refit" || definition.measure == "rebuild"))
            describe_host(row, loop_threads());
        else
            describe(row, fixture.device(0));
        if (definition.measure == "frame")
            add_frames(settings, entry,
                       variant.refitted ? MovingFrames::Motion::wave_refitted : MovingFrames::Motion::wave_built);
        else if (definition.measure == "object")
            add_frames(settings, entry, variant.refitted ? MovingFrames::Motion::object : MovingFrames::Motion::nothing);
        else if (definition.measure == "clip")
            add_frames(settings, entry,
                       variant.sends_vertices ? MovingFrames::Motion::clip_sent
                       : variant.refitted     ? MovingFrames::Motion::clip_refitted
                                              : MovingFrames::Motion::clip_built);
        else if (variant.on_device)
            add_device_refit(settings, entry);
        else if (definition.measure == "refit")
            add_refit(plugin, settings, entry);
        else if (definition.measure == "rebuild")
            add_rebuild(plugin, settings, entry);
        else
            add_rays(plugin, settings, entry, variant.refitted);
    }

    std::shared_ptr<Mover> make_mover(const rt_plugin& plugin, const Settings& settings) {
        auto mover = std::make_shared<Mover>();
        mover->built = std::make_shared<const AccelData>(
            build_accel(*fixture.scene(), plugin, settings.accel_params, progress, fixture.target_of(plugin)));
        mover->accel = std::make_unique<HostMover>(fixture.scene(), mover->built);
        if (mover->accel->cannot()) throw Error(Exit::usage, mover->accel->cannot().text());
        for (const Pose& pose : poses_) move(*mover, pose);
        return mover;
    }
    void move(Mover& mover, const Pose& pose) {
        mover.moved = mover.accel->move(pose, progress);
        if (!mover.moved.accel) throw Error(Exit::failed, "the structure cannot follow: " + mover.moved.why);
        mover.now = mover.moved.accel;
        mover.moved.accel.reset();
    }

    // time_ms: from vertices in place to the finished structure, as the baseline is timed. wall_ms: with the copy of the
    // vertices.
    void add_refit(const rt_plugin& plugin, const Settings& settings, Entry& entry) {
        const std::shared_ptr<Mover> mover = make_mover(plugin, settings);
        const bool in_place = std::all_of(poses_[0].meshes.begin(), poses_[0].meshes.end(),
                                          [&](const PosedMesh& mesh) { return mover->accel->vertices(mesh.mesh) != nullptr; });
        entry.once = [=] {
            const Pose& pose = poses_[mover->next++ % poses_.size()];
            const auto begin = std::chrono::steady_clock::now();
            if (in_place) {
                for (const PosedMesh& mesh : pose.meshes) {
                    copy_positions(mesh.positions.data(), mesh.positions.size(), mover->accel->vertices(mesh.mesh));
                    mover->accel->touch(mesh.mesh);
                }
                mover->moved = mover->accel->refit(progress);
                mover->now = std::move(mover->moved.accel);
            } else {
                move(*mover, pose);
            }
            return Sample{mover->moved.ms, ms_since(begin)};
        };
        entry.finish = [=](BenchRecord& row) {
            describe(row, *mover->built);
            row.accel_bytes = mover->built->bytes + mover->accel->state_bytes();
            row.bytes_per_triangle = double(row.accel_bytes) / double(row.triangles);
            row.sah_cost *= mover->moved.worst_cost_ratio;
        };
    }

    bool moves_on_device(const Variant& variant) const {
        const rt_plugin* plugin = plugins.accel(variant.accel.substr(0, variant.accel.find(',')));
        return !fixture.device(0).cpu && plugin && device_build_of(plugins.layout_of(*plugin)).refit &&
               (definition.measure != "frame" || variant.refitted || device_build_of(*plugin).topology);
    }

    // time_ms: from the start of the first kernel to the end of the last one, by the device's clock. Vertices are in place.
    // wall_ms: from the call to the end, with the copy of the vertices within the device.
    void add_device_refit(const Settings& settings, Entry& entry) {
        struct State {
            std::shared_ptr<const MultiPrepared> prepared;
            std::unique_ptr<DeviceMover> motion;
            std::vector<cl::Buffer> poses;
            size_t next = 0;
        };
        const auto state = std::make_shared<State>();
        const std::shared_ptr<Device> device = fixture.opened(0);
        auto apart = std::make_shared<Scene>(*fixture.scene());
        for (Instance& instance : apart->instances) instance.apart = true;
        state->prepared = MultiPreparer(plugins, {device}).prepare(apart, settings, progress);
        const Prepared& built = *state->prepared->first();
        state->motion = std::make_unique<DeviceMover>(device, apart, built.accel, built.on_device);
        if (state->motion->cannot()) throw Error(Exit::usage, state->motion->cannot().text());
        for (const Pose& pose : poses_) {
            const MovedOnDevice moved = state->motion->move(pose);
            if (!moved.on_device) throw Error(Exit::failed, "the structure cannot follow: " + moved.why);
            const cl::Buffer& now = state->motion->vertices();
            const auto bytes = now.getInfo<CL_MEM_SIZE>();
            state->poses.emplace_back(device->context(), CL_MEM_READ_WRITE, bytes);
            device->queue().enqueueCopyBuffer(now, state->poses.back(), 0, 0, bytes);
        }
        device->queue().finish();
        entry.once = [=] {
            const cl::Buffer& from = state->poses[state->next++ % state->poses.size()];
            const auto begin = std::chrono::steady_clock::now();
            device->queue().enqueueCopyBuffer(from, state->motion->vertices(), 0, 0, from.getInfo<CL_MEM_SIZE>());
            for (const PosedMesh& mesh : poses_[0].meshes) state->motion->touch(mesh.mesh);
            const MovedOnDevice moved = state->motion->update();
            moved.end.wait();
            const double wall_ms = ms_since(begin);
            return Sample{span_ms(moved.begin, moved.end, wall_ms), wall_ms};
        };
        entry.finish = [=](BenchRecord& row) { describe(row, *state->prepared->first()->accel); };
    }

    // time_ms: of all kernels of a frame. wall_ms: from one frame to the next.
    void add_frames(const Settings& settings, Entry& entry, MovingFrames::Motion motion) {
        const auto frames = std::make_shared<MovingFrames>(plugins, fixture.opened(0), *fixture.scene(), settings,
                                                           fixture.view(), motion, progress);
        describe(entry.row, frames->prepared());
        entry.once = [=] { return frames->play(progress); };
        entry.finish = [=](BenchRecord& row) { row.kernels_ms = frames->parts(); };
    }

    void add_rebuild(const rt_plugin& plugin, const Settings& settings, Entry& entry) {
        const auto next = std::make_shared<size_t>(0);
        add_build(entry, [=, &plugin] {
            return build_accel(*moved_[(*next)++ % moved_.size()], plugin, settings.accel_params, progress,
                               fixture.target_of(plugin));
        });
    }

    // Rays in the last pose, on a structure that was refitted or built for it.
    void add_rays(const rt_plugin& plugin, const Settings& settings, Entry& entry, bool refitted) {
        const std::shared_ptr<const Scene>& scene = moved_.back();
        std::shared_ptr<const AccelData> accel;
        if (refitted)
            accel = make_mover(plugin, settings)->now;
        else
            accel = std::make_shared<const AccelData>(
                build_accel(*scene, plugin, settings.accel_params, progress, fixture.target_of(plugin)));
        Fixture::Held held;
        held.prepared = MultiPreparer(plugins, {fixture.opened(0)}).prepare(scene, settings, progress, accel);
        held.queries = std::make_shared<RayQueries>(fixture.opened(0));
        describe(entry.row, *held.prepared->first());
        if (rays_.rays.empty()) make_rays(held);
        time_rays(state_, entry, held, rays_);
        entry.finish = [=](BenchRecord& row) {
            std::vector<float> distances;
            for (const rt_hit& hit : held.queries->trace(*held.prepared->first(), rays_.rays)) distances.push_back(hit.t);
            state_.agreement.check_hits(row, rays_, distances);
        };
    }
    void make_rays(const Fixture::Held& held) {
        const Settings settings = variant_settings(plugins, request, {});
        const View& view = fixture.view();
        rays_ = camera_rays(view.camera, settings.width, settings.height);
        if (definition.measure == rays_.kind) return;
        const auto trace = [&](const std::vector<rt_ray>& rays) { return held.queries->trace(*held.prepared->first(), rays); };
        const RaySet primary = std::move(rays_);
        rays_ = {};
        if (view.lights.empty()) throw Error(Exit::usage, "no " + definition.measure + " rays: the scene has no light");
        for (RaySet& set : secondary_rays(*moved_.back(), view.lights[0], primary, settings.width, settings.height, trace))
            if (set.kind == definition.measure) rays_ = std::move(set);
    }

    void add_baseline(const std::string& quality) {
        if (!fixture.has_baselines()) return;
        Entry& entry = state_.add_entry();
        entry.row.baseline = entry.row.variant = "embree " + quality;
        entry.row.baseline_quality = quality;
        describe_host(entry.row, fixture.baseline_threads());
        entry.row.driver = baseline_version();
        run_or_mark_failed(entry, [&](BenchRecord&) {
            const std::shared_ptr<MovingBaseline> baseline =
                make_moving_baseline(fixture.baseline_mesh(), quality, fixture.baseline_threads());
            if (!baseline) throw Error(Exit::usage, "this program was built without Embree (libembree-dev): no peers");
            const auto moved = std::make_shared<std::vector<BaselineMesh>>();
            for (const Pose& pose : poses_) moved->push_back(make_baseline_mesh(posed(*fixture.scene(), pose)));
            const auto next = std::make_shared<size_t>(0);
            entry.once = [=] {
                const BaselineMesh& mesh = (*moved)[(*next)++ % moved->size()];
                const auto begin = std::chrono::steady_clock::now();
                copy_positions(mesh.positions.data(), mesh.positions.size(), baseline->positions());
                const double ms = baseline->update_ms();
                return Sample{ms, ms_since(begin)};
            };
            entry.finish = [=](BenchRecord& row) {
                row.accel_bytes = baseline->bytes();
                row.bytes_per_triangle = double(row.accel_bytes) / double(row.triangles);
            };
        });
    }

    CaseState state_;
    std::vector<Pose> poses_;
    std::vector<std::shared_ptr<const Scene>> moved_;
    RaySet rays_;
};

}  // namespace

std::vector<BenchRecord> measure_motion(const CaseRun& run) {
    return MotionCase(run).run();
}

}  // namespace clarity::bench
