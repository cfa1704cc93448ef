#include "cli/render/frame_output.hpp"

#include <filesystem>
#include <utility>

#include "base/digest.hpp"
#include "base/elapsed.hpp"
#include "base/host_name.hpp"
#include "base/numbers.hpp"
#include "cli/render/frame_record.hpp"
#include "cli/render/picture_digest.hpp"

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

}  // namespace clarity
