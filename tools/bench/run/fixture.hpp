// fixture.hpp -- fixture of a benchmark case: one scene, its rays, and everything built from it (structures, device buffers,
// baselines).
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "stand/multi_frame_renderer.hpp"
#include "tools/bench/baselines/baseline.hpp"
#include "tools/bench/suites/suite.hpp"
#include "tracers/rays/ray_queries.hpp"

namespace clarity::bench {

class Fixture {
 public:
    Fixture(const PluginRegistry& plugins, const std::vector<DeviceInfo>& devices, const import::ImportOptions& import);
    ~Fixture();

    size_t device_count() const { return devices_.size(); }
    const DeviceInfo& device(size_t i) const;
    const std::shared_ptr<Device>& opened(size_t i) const;
    // Threads of baselines: the compute units of the first CPU among the devices. 0: there is no CPU, and thus no baselines.
    unsigned baseline_threads() const;
    // Whether baselines measure the scene. If its primitives are the reason why not, a warning says so, once a scene.
    bool has_baselines();

    // Loads a scene and frees everything of the previous one. Throws what load_scene throws, and Error(failed) if the scene
    // does not fit into free memory. width, height: size of the rays' picture in pixels.
    void load(const SuiteScene& scene, int width, int height, Progress& progress);
    const std::shared_ptr<const Scene>& scene() const { return loaded_.scene; }
    const View& view() const { return loaded_.view; }

    // A structure with its program, and a film and ray buffers of its own, so that interleaved measuring does not disturb its
    // pace.
    struct Held {
        std::shared_ptr<const MultiPrepared> prepared;
        std::shared_ptr<MultiFrameRenderer> frames;
        std::shared_ptr<RayQueries> queries;
    };
    // Builds it on first use and keeps it until the next scene. Throws what MultiPreparer::prepare() throws.
    const Held& prepare(size_t device, const Settings& settings, Progress& progress);

    // What a builder is told if it builds for the first device.
    BuildTarget target_of(const rt_plugin& accel) const;

    // Prepares the scene on all devices, to share pictures.
    std::shared_ptr<const MultiPrepared> prepare_all(const Settings& settings, Progress& progress);

    // The rays of one kind. All kinds are made at the first call per scene, from the hits that `held` finds. Throws
    // Error(failed) if there are no such rays.
    const RaySet& rays(const std::string& kind, const Held& held);

    // Built on first use and kept until the next scene.
    BaselineScene& baseline(const BaselineKind& kind);
    const BaselineMesh& baseline_mesh();

 private:
    const PluginRegistry& plugins_;
    const import::ImportOptions import_;
    Devices devices_;
    std::vector<std::unique_ptr<MultiPreparer>> preparers_;  // of each by itself
    std::unique_ptr<MultiPreparer> together_;
    LoadedScene loaded_;
    std::string scene_name_;
    bool warned_of_baselines_ = false;
    int width_ = 0, height_ = 0;
    std::map<std::string, Held> held_;
    std::vector<RaySet> rays_;
    std::unique_ptr<BaselineMesh> baseline_mesh_;
    std::map<std::string, std::unique_ptr<BaselineScene>> baselines_;
};

}  // namespace clarity::bench
