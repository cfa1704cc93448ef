// workbench.hpp -- one device, one registry and one cache of kernels for all tests of a process.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "plugin/registry.hpp"
#include "render/frame/renderer.hpp"

namespace clarity::test {

using ScenePtr = std::shared_ptr<const Scene>;

class Workbench {
 public:
    static Workbench& get();

    const PluginRegistry& plugins() const { return plugins_; }
    const Device& device() const { return *device_; }
    // For tests of what becomes of a picture after tracing, and of what works beside the frames.
    const std::shared_ptr<Device>& shared_device() const { return device_; }
    FrameRenderer& frames() { return frames_; }
    // Ids of every structure found, so that a new one is tested without a change here.
    std::vector<std::string> accels() const;
    // The same without those that try everything, for scenes that would take them minutes.
    std::vector<std::string> fast_accels() const;

    std::shared_ptr<const Prepared> prepare(const ScenePtr& scene, const Settings& settings);
    // One sample into frames().
    FrameStats trace(const ScenePtr& scene, const Settings& settings, const View& view, unsigned sample = 0);
    // The same, and what an AOV is or a colour, as Frames::read_values() gives it.
    FloatImage values(const ScenePtr& scene, const Settings& settings, const View& view, FrameStats* stats = nullptr);
    ByteImage display(const ScenePtr& scene, const Settings& settings, const View& view, FrameStats* stats = nullptr);
    std::vector<rt_hit> rays(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays, bool any_hit);
    std::vector<rt_hit> rays(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays, RayQuery query);

 private:
    Workbench();
    PluginRegistry plugins_;
    std::shared_ptr<Device> device_;
    Progress progress_;
    Preparer preparer_;
    FrameRenderer frames_;
};

// Settings by their keys: make_settings({{"accel", "bvh2"}, {"lanes", "16"}, {"packet", "4x4"}, {"size", "256x192"}}).
Settings make_settings(const std::vector<std::pair<std::string, std::string>>& pairs);

// One way of cutting the work up.
struct Configuration {
    std::string accel;
    int lanes, packet_w, packet_h;
    std::string text() const;
    void apply(Settings& settings) const;
};
// Every pair of lanes and packet once, the structures taken in turn, so that each structure also meets every lane count and
// every packet: all pairs, not the whole product.
std::vector<Configuration> all_pairs(const std::vector<std::string>& accels);
// Each structure with each lane count, the packets in turn.
std::vector<Configuration> each_accel_and_lanes(const std::vector<std::string>& accels);

}  // namespace clarity::test
