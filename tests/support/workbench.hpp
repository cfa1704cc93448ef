// workbench.hpp -- one device, one registry and one kernel cache for all tests of a process.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "frames/frame_renderer.hpp"
#include "frames/preparer.hpp"
#include "plugin/registry.hpp"
#include "support/quick.hpp"
#include "tracers/rays/ray_queries.hpp"

namespace clarity::test {

using ScenePtr = std::shared_ptr<const Scene>;

// Prepares and traces scenes on the default device. Used from one thread.
class Workbench {
 public:
    static Workbench& get();

    const PluginRegistry& plugins() const { return plugins_; }
    const Device& device() const { return *device_; }
    // For tests of what follows tracing, and of objects that work beside the renderer.
    const std::shared_ptr<Device>& shared_device() const { return device_; }
    FrameRenderer& frames() { return frames_; }
    RayQueries& queries() { return queries_; }
    // Ids of all structures, so that new ones are tested without a change here. Quick tests (the environment variable
    // CLARITY_QUICK_TESTS, which ./test sets) take some of them, and fewer lane counts and packets below.
    std::vector<std::string> accels() const;
    // The same without structures that test every primitive: on large scenes they would take minutes.
    std::vector<std::string> fast_accels() const;

    // For views with any lights and surfaces, or for one view.
    std::shared_ptr<const Prepared> prepare(const ScenePtr& scene, const Settings& settings);
    std::shared_ptr<const Prepared> prepare(const ScenePtr& scene, const Settings& settings, const View& view);
    // Traces one sample into frames().
    FrameStats trace(const ScenePtr& scene, const Settings& settings, const View& view, unsigned sample = 0);
    // The same, and returns the film's values as FrameRenderer::read_values() does.
    FloatImage values(const ScenePtr& scene, const Settings& settings, const View& view, FrameStats* stats = nullptr);
    ByteImage display(const ScenePtr& scene, const Settings& settings, const View& view, FrameStats* stats = nullptr);
    std::vector<rt_hit> rays(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays, bool any_hit);
    std::vector<rt_hit> rays(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays, RayQuery query);

 private:
    Workbench();
    bool is_default(const rt_plugin& plugin) const;  // on this device
    PluginRegistry plugins_;
    std::shared_ptr<Device> device_;
    Progress progress_;
    Preparer preparer_;
    FrameRenderer frames_;
    RayQueries queries_;
};

inline Workbench& bench() {
    return Workbench::get();
}

// It is 1, as ./test sets it, and not `faults`, as where a planted fault must be found: of several ways to one end, such as
// tracers, some are enough.
bool few_ways();
// The numbers of lanes that tests of kernels try.
std::vector<int> lane_counts();
// Of a structure: the narrowest and the widest if its traversal is written for one ray, since the host spreads packets over it
// by the same text for all of them.
std::vector<int> lane_counts(const std::string& accel);

// Settings by key: make_settings({{"accel", "bvh2"}, {"lanes", "16"}, {"packet", "4x4"}, {"size", "256x192"}}).
Settings make_settings(const std::vector<std::pair<std::string, std::string>>& pairs);

// A structure, and how its work is divided.
struct Configuration {
    std::string accel;
    int lanes, packet_w, packet_h;
    std::string text() const;
    void apply(Settings& settings) const;
};
// Every pair of lanes and packet once, with the structures in turn. Each structure thus meets every lane count and every
// packet: all pairs instead of the whole product.
std::vector<Configuration> all_pairs(const std::vector<std::string>& accels);
// Each structure with each lane count, with the packets in turn.
std::vector<Configuration> each_accel_and_lanes(const std::vector<std::string>& accels);

}  // namespace clarity::test
