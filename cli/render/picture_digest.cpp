#include "cli/render/picture_digest.hpp"

#include <algorithm>

#include "base/digest.hpp"
#include "base/numbers.hpp"
#include "cli/render/picture_goal.hpp"
#include "device/kernel_files.hpp"
#include "launch/prepared.hpp"
#include "view/settings/aov.hpp"
#include "view/settings/settings.hpp"

namespace clarity {
namespace {

void add_settings_to(Digest& digest, const Settings& settings, bool display) {
    const Aov& aov = find_aov(settings.aov);
    const bool cost = aov.about == Aov::About::cost;
    const std::string shows = picture_of_tracer(aov.tracer ? aov.tracer : settings.tracer);
    if (!aov.tracer) digest.add(shows);
    for (const Setting& row : settings_table()) {
        if (!row.changes_picture && !cost) continue;
        if (row.effect == Effect::display && !display) continue;
        if (!row.picture.empty() && row.picture != shows) continue;
        digest.add(row.key);
        digest.add(row.get(settings));
    }
    if (!cost) return;
    digest.add(settings.accel);
    for (const double parameter : settings.accel_params) digest.add_value(parameter);
}

void add_kernels_to(Digest& digest, const Scene& scene) {
    for (const std::string& name : kernel_names()) digest.add(name), digest.add(kernel_text(name));
    for (const ShapeKind& kind : scene.shape_kinds)
        if (kind.plugin) digest.add(plugin_kernel_text(*kind.plugin, kind.plugin->primitive->kernels));
}

}  // namespace

PictureDigests::PictureDigests(FrameScene& scene, const Settings& settings, const RenderOptions& options) : scene_(scene) {
    Digest digest;
    digest.add(CLARITY_VERSION);
    add_kernels_to(digest, *scene.imported());
    add_settings_to(digest, settings, writes_display(options.output));
    digest.add_value(options.all_aovs);
    if (denoises(settings)) digest.add("denoised");
    if (!options.crop.empty()) digest.add(options.crop);
    if (has_goal(options)) digest.add_value(options.error), digest.add_value(options.time_budget_s);
    common_ = digest.hex();
}

const std::string& PictureDigests::of(std::optional<int> frame) {
    std::string& known = known_[frame];
    if (known.empty()) {
        Digest digest;
        digest.add(common_);
        scene_.describe(digest, frame);
        known = digest.hex();
    }
    return known;
}

std::string pixel_digest(const FloatImage& image) {
    Digest digest;
    for (const unsigned size : {image.width, image.height, image.channels}) digest.add_value(size);
    digest.add_bytes(image.pixels.data(), image.pixels.size() * sizeof(float));
    return digest.hex();
}

std::string pixel_digest(const ByteImage& image) {
    Digest digest;
    for (const unsigned size : {image.width, image.height}) digest.add_value(size);
    digest.add_bytes(image.pixels.data(), image.pixels.size());
    return digest.hex();
}

std::string way_of_tracing(const std::vector<DeviceInfo>& devices, const MultiPrepared& prepared) {
    // Devices of one kind give the same bits, however many they are.
    std::vector<std::string> kinds;
    for (const DeviceInfo& device : devices) kinds.push_back(device.name_of_whole() + " (" + device.driver + ")");
    std::sort(kinds.begin(), kinds.end());
    kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
    std::string way;
    for (const std::string& kind : kinds) way += kind + ", ";
    const Settings& settings = prepared.first()->settings;
    return way + settings.accel + ", " + settings.tracer + ", kernel " + prepared.kernel_digest();
}

}  // namespace clarity
