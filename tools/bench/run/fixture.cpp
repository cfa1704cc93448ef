#include "tools/bench/run/fixture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "tools/bench/output/machine.hpp"
#include "tools/bench/scenes/subdivide.hpp"
#include "view/view.hpp"

namespace clarity::bench {
namespace {

// Estimate of the host memory per triangle, in bytes, while three structures, a baseline and their inputs are held and one more
// structure is built.
constexpr uint64_t kBytesPerTriangle = 600;

// Identifies a structure with its program: the device and all settings which need another structure or program.
std::string key_of(size_t device, const Settings& settings) {
    std::string key = std::to_string(device) + " " + settings.accel;
    for (const double value : settings.accel_params) key += "," + exact_text(value);
    for (const Setting& setting : settings_table())
        if (!setting.at_once()) key += " " + setting.get(settings);
    return key;
}

void check_memory(uint64_t triangles) {
    const uint64_t free = free_memory_bytes();
    if (free == 0 || triangles * kBytesPerTriangle <= free) return;
    char millions[32];
    std::snprintf(millions, sizeof millions, "%.1f M", 1e-6 * double(triangles));
    throw Error(Exit::failed, std::string(millions) + " triangles would take about " +
                                  memory_text(triangles * kBytesPerTriangle) + " of memory, " + memory_text(free) +
                                  " are free: take a smaller --max-triangles");
}

}  // namespace

Fixture::Fixture(const PluginRegistry& plugins, const std::vector<DeviceInfo>& devices, const import::ImportOptions& import)
    : plugins_(plugins), import_(import) {
    for (const DeviceInfo& info : devices) {
        devices_.push_back(std::make_shared<Device>(info));
        preparers_.push_back(std::make_unique<MultiPreparer>(plugins, Devices{devices_.back()}));
    }
}
Fixture::~Fixture() = default;

const DeviceInfo& Fixture::device(size_t i) const {
    return devices_[i]->info();
}

const std::shared_ptr<Device>& Fixture::opened(size_t i) const {
    return devices_[i];
}

unsigned Fixture::baseline_threads() const {
    for (const auto& device : devices_)
        if (device->info().cpu) return device->info().compute_units;
    return 0;
}

bool Fixture::has_baselines() {
    if (baseline_threads() == 0 || baseline_kinds(nullptr).empty()) return false;  // run_bench() says it
    const Problem cannot = baselines_cannot(*scene());
    if (cannot && !std::exchange(warned_of_baselines_, true))
        log(LogLevel::warning, scene_name_ + ": peers are left out: " + cannot.text());
    return !cannot;
}

void Fixture::load(const SuiteScene& scene, int width, int height, Progress& progress) {
    baselines_.clear();
    baseline_mesh_.reset();
    rays_.clear();
    held_.clear();
    together_.reset();
    loaded_ = {};
    scene_name_ = scene.source.name;
    warned_of_baselines_ = false;
    width_ = width;
    height_ = height;
    loaded_ = load_scene(plugins_, scene.source, float(width) / float(height), import_, progress);
    if (scene.subdivide_to == 0) return;
    const double base = double(loaded_.scene->placed_triangle_count());
    const double n = std::round(std::sqrt(double(scene.subdivide_to) / std::max(base, 1.0)));
    if (base == 0) throw Error(Exit::failed, "the scene has no triangles to split");
    if (n < 1)
        throw Error(Exit::failed, "the scene has " + std::to_string(uint64_t(base)) + " triangles, more than the " +
                                      std::to_string(scene.subdivide_to) + " wanted");
    check_memory(uint64_t(base * n * n));
    progress.stage("splitting " + scene.source.name);
    progress.report(-1);
    loaded_.scene = std::make_shared<const Scene>(subdivide(*loaded_.scene, unsigned(n)));
}

const Fixture::Held& Fixture::prepare(size_t device, const Settings& settings, Progress& progress) {
    Held& held = held_[key_of(device, settings)];
    if (!held.frames) {
        held.prepared = preparers_[device]->prepare(loaded_.scene, with_optics(settings, *loaded_.scene, view()), progress);
        held.frames = std::make_shared<MultiFrameRenderer>(Devices{devices_[device]});
        held.queries = std::make_shared<RayQueries>(devices_[device]);
    }
    return held;
}

BuildTarget Fixture::target_of(const rt_plugin& accel) const {
    return {&plugins_.layout_of(accel), device_for_builders(device(0), device(0).preferred_lanes())};
}

std::shared_ptr<const MultiPrepared> Fixture::prepare_all(const Settings& settings, Progress& progress) {
    if (!together_) together_ = std::make_unique<MultiPreparer>(plugins_, devices_);
    return together_->prepare(loaded_.scene, with_optics(settings, *loaded_.scene, view()), progress);
}

const RaySet& Fixture::rays(const std::string& kind, const Held& held) {
    if (rays_.empty()) {
        rays_.push_back(camera_rays(loaded_.view.camera, width_, height_));
        const auto trace = [&](const std::vector<rt_ray>& rays) { return held.queries->trace(*held.prepared->first(), rays); };
        if (!loaded_.view.lights.empty())
            for (RaySet& set : secondary_rays(*loaded_.scene, loaded_.view.lights[0], rays_[0], width_, height_, trace))
                rays_.push_back(std::move(set));
    }
    const auto found = std::find_if(rays_.begin(), rays_.end(), [&](const RaySet& set) { return set.kind == kind; });
    if (found == rays_.end()) throw Error(Exit::failed, "no " + kind + " rays: the scene has no light");
    if (found->active == 0) throw Error(Exit::failed, "no " + kind + " rays: the camera sees nothing of the scene");
    return *found;
}

const BaselineMesh& Fixture::baseline_mesh() {
    if (!baseline_mesh_) baseline_mesh_ = std::make_unique<BaselineMesh>(make_baseline_mesh(*loaded_.scene));
    return *baseline_mesh_;
}

BaselineScene& Fixture::baseline(const BaselineKind& kind) {
    std::unique_ptr<BaselineScene>& baseline = baselines_[kind.name + " " + kind.quality];
    if (!baseline) baseline = kind.build(baseline_mesh(), kind.quality, baseline_threads());
    return *baseline;
}

}  // namespace clarity::bench
