// frame_record.hpp -- the record beside a frame, out_0001.json beside out_0001.exr: what it shows, and who rendered it.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "cli/commands.hpp"

namespace clarity {

struct FrameRecord {
    int frame = 0;
    std::string picture;                      // name of its file, without the folder
    std::string digest;                       // PictureDigests::of()
    std::string pixels;                       // digest of the pixels before they were encoded
    std::string file_digest;                  // of the picture's file, so that a record of another file is noticed
    double seconds = 0;                       // for preparing and rendering
    unsigned samples = 0, of_checkpoint = 0;  // of a pixel; how many of them come from a checkpoint
    std::string host, device, command;        // command: render_words()
    RenderOptions options;                    // that render this frame alone: scene, trace, frames, pose and fps
};

// The path of the record of a picture.
std::string record_path(const std::string& picture);
// Writes the record. Paths of files are made absolute. Throws Error(failed).
void write_record(const FrameRecord& record, const std::string& path);
// Throws Error(failed), which says why the file is no record.
FrameRecord read_record(const std::string& path);

// Whether there is a whole picture of this digest: its record names it, and the file is the one that the record was written
// for.
bool is_rendered(const std::string& picture, const std::string& digest);

// The command that renders a picture like this, as a user would type it: without the device, the output and all that only says
// how the work is done. frame: none if frames do not differ.
std::string render_words(const RenderOptions& options, std::optional<int> frame);

}  // namespace clarity
