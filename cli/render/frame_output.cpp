#include "cli/render/frame_output.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/digest.hpp"
#include "base/elapsed.hpp"
#include "base/machine.hpp"
#include "base/numbers.hpp"
#include "cli/render/frame_record.hpp"
#include "cli/render/picture_digest.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

void record_frame(const RenderOptions& options, const FrameFile& file, const std::string& command, const std::string& pixels) {
    FrameRecord record;
    record.frame = file.frame;
    record.picture = std::filesystem::path(file.path).filename().string();
    record.digest = file.digest;
    record.pixels = pixels;
    record.file_digest = digest_of_file(file.path);
    record.seconds = seconds_since(file.begin);
    record.samples = file.samples;
    record.of_checkpoint = file.of_checkpoint;
    record.host = host_name();
    record.device = file.device;
    record.command = command;
    record.options = options;
    if (!options.frames.empty()) record.options.frames = std::to_string(file.frame);
    write_record(record, record_path(file.path));
}

}  // namespace

void write_frame(const RenderOptions& options, const FrameFile& file, FramePixels pixels) {
    const std::string command = render_words(options, file.moves ? std::optional<int>(file.frame) : std::nullopt);
    PictureNotes notes = picture_notes(file.denoised);
    notes.texts.insert(notes.texts.end(), {{"Command", command}, {"Digest", file.digest}});
    if (file.noise) {
        notes.texts.emplace_back("Samples", exact_text(float(file.noise->mean_samples)));
        notes.texts.emplace_back("Estimated error", exact_text(float(file.noise->error)));
    }
    // A frame that others wait for, or that took long, must outlast a power cut.
    notes.sync = file.has_record || !options.checkpoint.empty() || !options.resume.empty();
    std::string digest = writes_display(file.path) ? pixel_digest(pixels.display) : pixel_digest(pixels.values);
    if (options.all_aovs) {
        for (const PictureLayer& layer : pixels.layers) digest = digest_of(digest + pixel_digest(layer.values));
        pixels.layers.insert(pixels.layers.begin(), {"", std::move(pixels.values)});
        write_layers(file.path, pixels.layers, notes);
    } else {
        write_image(file.path, pixels.values, pixels.display, notes);
    }
    if (file.has_record) record_frame(options, file, command, digest);
}

RenderOptions with_all_aovs(const RenderOptions& options) {
    RenderOptions result = options;
    auto& pairs = result.trace.settings;
    auto& sets = result.trace.sets;
    // The last one counts, and an option of its own overrides --set.
    const auto is_aov = [](const auto& pair) { return pair.first == "aov"; };
    const auto pair = std::find_if(pairs.rbegin(), pairs.rend(), is_aov);
    const auto set =
        std::find_if(sets.rbegin(), sets.rend(), [](const std::string& word) { return word.rfind("aov=", 0) == 0; });
    const bool all = pair != pairs.rend() ? pair->second == "all" : set != sets.rend() && *set == "aov=all";
    if (!all) return result;
    result.all_aovs = true;
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_aov), pairs.end());
    sets.erase(std::remove_if(sets.begin(), sets.end(), [](const std::string& word) { return word.rfind("aov=", 0) == 0; }),
               sets.end());
    pairs.emplace_back("aov", aov_table().front().name);  // of a preset, too
    return result;
}

std::vector<PictureLayer> trace_aov_layers(MultiFrameRenderer& frames, MultiPreparer& preparer,
                                           const std::shared_ptr<const Scene>& scene, const View& view, Settings settings,
                                           Progress& progress) {
    std::vector<PictureLayer> layers;
    settings.spp = 1;
    for (const Aov& aov : aov_table()) {
        if (aov.about != Aov::About::first_hit) continue;
        settings.aov = aov.name;
        frames.trace(preparer.prepare(scene, settings, progress), settings, view, 0, false, progress);
        layers.push_back({aov.name, frames.read_values()});
    }
    return layers;
}

}  // namespace clarity
