// frame_output.hpp -- writes the file of a frame, with its notes and its record.
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "base/pictures/image_io.hpp"
#include "cli/commands.hpp"
#include "picture/film_noise.hpp"
#include "stand/multi_frame_renderer.hpp"

namespace clarity {

// display: of a PNG; values: of other formats; layers: of --aov all, besides the colours in `values`.
struct FramePixels {
    FloatImage values;
    ByteImage display;
    std::vector<PictureLayer> layers;
};
struct FrameFile {
    std::string path, digest;  // digest: PictureDigests::of()
    int frame = 1;
    bool moves = false;       // each frame is another picture
    bool has_record = false;  // which is written after the picture
    bool denoised = false;
    unsigned samples = 0, of_checkpoint = 0;
    std::optional<FilmNoise> noise;  // of `path`
    std::string device;
    std::chrono::steady_clock::time_point begin;  // of the work on this frame
};
// Throws Error(failed), which names the file and the reason; then neither is there.
void write_frame(const RenderOptions& options, const FrameFile& file, FramePixels pixels);

// --aov all: the colours and everything about the first hit, as layers of one file.

// Takes `--aov all` out of the options and notes it in all_aovs; the settings know single quantities only.
RenderOptions with_all_aovs(const RenderOptions& options);

// Traces every quantity of the first hit, at the centres of the pixels, in the order of aov_table(). Those of cost are left
// out: they describe the tracer and not the picture. The film of `frames` is lost. Throws what MultiPreparer::prepare() and
// MultiFrameRenderer::trace() throw.
std::vector<PictureLayer> trace_aov_layers(MultiFrameRenderer& frames, MultiPreparer& preparer,
                                           const std::shared_ptr<const Scene>& scene, const View& view, Settings settings,
                                           Progress& progress);

}  // namespace clarity
