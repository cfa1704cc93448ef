#include "support/workbench.hpp"

#include <array>
#include <cstdlib>
#include <cstring>

#include "view/settings/accel_choice.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity::test {
namespace {

std::vector<std::array<int, 2>> packets() {
    if (quick()) return {{1, 1}, {3, 5}, {8, 8}};
    return {{1, 1}, {2, 2}, {3, 5}, {4, 4}, {8, 8}};
}

// Kernels that know more lights and surfaces make the same pictures, bit by bit (kernels/optics_test.cpp). So where time
// counts, paths are traced by two kinds of programs, which scenes share: without and with the layers of glTF.
Settings with_shared_optics(Settings settings) {
    if (!few_ways() || picture_of_tracer(settings.tracer) != kPathPicture) return settings;
    constexpr rt_u32 kCore = RT_LOBE_MIRROR | RT_LOBE_METAL | RT_LOBE_GLASS | RT_LOBE_FROSTED | RT_LOBE_ABSORBS;
    settings.optics.lights = RT_LIGHTS_ALL;
    settings.optics.lobes |= settings.optics.lobes & RT_LOBES_ALL & ~kCore ? RT_LOBES_ALL : kCore;
    return settings;
}

}  // namespace

// Most of a test's time is the compiler's: seconds for each structure, lane count and class of packets. Quick tests take the
// structure that users of this device get without asking, `linear`, the widest and the narrowest lanes, and three packets.
bool few_ways() {
    static const bool are_few = quick() && std::strcmp(std::getenv("CLARITY_QUICK_TESTS"), "faults") != 0;
    return are_few;
}

std::vector<int> lane_counts() {
    return quick() ? std::vector<int>{1, 16} : std::vector<int>{1, 4, 8, 16};
}

std::vector<int> lane_counts(const std::string& accel) {
    if (few_ways() && accel == "linear") return {16};
    const rt_plugin* const plugin = Workbench::get().plugins().accel(accel);
    const bool is_spread = plugin && (plugin->accel->capabilities & RT_TRAVERSES_SINGLE_RAYS);
    if (is_spread || quick()) return {1, 16};
    // Compiling takes most of a test's time, and 4 and 8 lanes differ only in the width of the vectors: every other structure
    // each.
    const auto& all = Workbench::get().plugins().accels();
    const auto place = std::find(all.begin(), all.end(), plugin) - all.begin();
    return {1, place % 2 ? 4 : 8, 16};
}

Workbench::Workbench()
    : plugins_(PluginRegistry::discover()),
      device_(std::make_shared<Device>(choose_device(""))),
      preparer_(plugins_, device_),
      frames_(device_),
      queries_(device_) {}

Workbench& Workbench::get() {
    // Never destroyed: at exit, an OpenCL driver may be unloaded before static objects are destroyed.
    static Workbench* const workbench = new Workbench;
    return *workbench;
}

bool Workbench::is_default(const rt_plugin& plugin) const {
    return &plugin == &best_accel(plugins_, kind_of({device_->info()}));
}

std::vector<std::string> Workbench::accels() const {
    std::vector<std::string> ids;
    for (const rt_plugin* plugin : plugins_.accels())
        if (plugin->id == std::string("linear") || !quick() || is_default(*plugin)) ids.push_back(plugin->id);
    return ids;
}

std::vector<std::string> Workbench::fast_accels() const {
    std::vector<std::string> ids;
    for (const rt_plugin* plugin : plugins_.accels())
        if (plugin->accel->ray_cost != RT_RAY_COST_LINEAR && (!quick() || is_default(*plugin))) ids.push_back(plugin->id);
    return ids;
}

std::shared_ptr<const Prepared> Workbench::prepare(const ScenePtr& scene, const Settings& settings) {
    Settings for_any = settings;
    for_any.optics = {RT_LIGHTS_ALL, RT_LOBES_ALL};
    return preparer_.prepare(scene, for_any, progress_);
}

std::shared_ptr<const Prepared> Workbench::prepare(const ScenePtr& scene, const Settings& settings, const View& view) {
    return preparer_.prepare(scene, with_shared_optics(with_optics(settings, *scene, view)), progress_);
}

FrameStats Workbench::trace(const ScenePtr& scene, const Settings& settings, const View& view, unsigned sample) {
    return frames_.trace(*prepare(scene, settings, view), settings, view, sample, true, progress_);
}

FloatImage Workbench::values(const ScenePtr& scene, const Settings& settings, const View& view, FrameStats* stats) {
    const FrameStats traced = trace(scene, settings, view);
    if (stats) *stats = traced;
    return frames_.read_values();
}

ByteImage Workbench::display(const ScenePtr& scene, const Settings& settings, const View& view, FrameStats* stats) {
    const FrameStats traced = trace(scene, settings, view);
    if (stats) *stats = traced;
    return frames_.read_display(settings);
}

std::vector<rt_hit> Workbench::rays(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays,
                                    bool any_hit) {
    return this->rays(scene, settings, rays, RayQuery{any_hit, false});
}

std::vector<rt_hit> Workbench::rays(const ScenePtr& scene, const Settings& settings, const std::vector<rt_ray>& rays,
                                    RayQuery query) {
    return queries_.trace(*prepare(scene, settings), rays, query);
}

Settings make_settings(const std::vector<std::pair<std::string, std::string>>& pairs) {
    Settings settings;
    for (const auto& [key, value] : pairs) {
        if (key == "accel")
            settings.accel = value;
        else
            set_setting(settings, key, value);
    }
    return settings;
}

std::string Configuration::text() const {
    return accel + ", " + std::to_string(lanes) + " lanes, packet " + std::to_string(packet_w) + "x" + std::to_string(packet_h);
}

void Configuration::apply(Settings& settings) const {
    settings.accel = accel;
    settings.lanes = lanes;
    settings.packet_w = packet_w;
    settings.packet_h = packet_h;
}

std::vector<Configuration> all_pairs(const std::vector<std::string>& accels) {
    std::vector<Configuration> all;
    size_t l = 0;
    for (const int lanes : lane_counts()) {
        size_t p = 0;
        for (const auto& packet : packets()) all.push_back({accels[(l + p++) % accels.size()], lanes, packet[0], packet[1]});
        ++l;
    }
    return all;
}

std::vector<Configuration> each_accel_and_lanes(const std::vector<std::string>& accels) {
    std::vector<Configuration> all;
    size_t p = 0;
    for (const std::string& accel : accels)
        for (const int lanes : lane_counts(accel)) {
            const auto packet = packets()[p++ % packets().size()];
            all.push_back({accel, lanes, packet[0], packet[1]});
        }
    return all;
}

}  // namespace clarity::test
