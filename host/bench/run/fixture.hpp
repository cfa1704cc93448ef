// fixture.hpp -- the test stand: one scene at a time, held by every structure, device and peer that a case asks for, and its
// rays.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/baselines/baseline.hpp"
#include "bench/suites/suite.hpp"
#include "render/multi/multi_frame_renderer.hpp"

namespace clarity::bench {

class Fixture {
 public:
    Fixture(const PluginRegistry& plugins, const std::vector<DeviceInfo>& devices, const import::ImportOptions& import);
    ~Fixture();

    size_t device_count() const { return places_.size(); }
    const DeviceInfo& device(size_t i) const;
    const std::shared_ptr<Device>& opened(size_t i) const;
    // Threads of peers: as many as the first CPU among the devices has. 0: there is none, and no peers then.
    unsigned baseline_threads() const;

    // Lets go of the last scene. Throws as load_scene does, and Error(failed) where it is larger than memory.
    void load(const SuiteScene& scene, int width, int height, Progress& progress);
    const std::shared_ptr<const Scene>& scene() const { return loaded_.scene; }
    const View& view() const { return loaded_.view; }

    // A structure and program, with a film and ray buffers of its own: taking turns with others does not disturb its pace.
    struct Held {
        std::shared_ptr<const Prepared> prepared;
        std::shared_ptr<FrameRenderer> frames;
    };
    // Kept until the next scene. Throws what Preparer::prepare throws.
    const Held& prepare(size_t device, const Settings& settings, Progress& progress);

    // On all devices, which are to share pictures.
    std::shared_ptr<const MultiPrepared> prepare_all(const Settings& settings, Progress& progress);

    // Made once a scene, from the hits that `held` finds.
    const RaySet& rays(const std::string& kind, const Held& held);

    // Built once a scene.
    BaselineScene& baseline(const BaselineKind& kind);
    const BaselineMesh& baseline_mesh();

 private:
    struct Place;
    const PluginRegistry& plugins_;
    const import::ImportOptions import_;
    std::vector<std::unique_ptr<Place>> places_;
    std::unique_ptr<MultiPreparer> together_;
    LoadedScene loaded_;
    int width_ = 0, height_ = 0;
    std::map<std::string, Held> held_;
    std::vector<RaySet> rays_;
    std::unique_ptr<BaselineMesh> baseline_mesh_;
    std::map<std::string, std::unique_ptr<BaselineScene>> baselines_;
};

}  // namespace clarity::bench
