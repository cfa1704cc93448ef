// frame_output.hpp -- writes the file of a frame, with its notes and its record.
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "render/film/film_noise.hpp"
#include "render/film/image_io.hpp"

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

}  // namespace clarity
