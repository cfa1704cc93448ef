// image_io.hpp -- writes pictures to files: PNG (8 bit, sRGB), EXR and PFM (float). A file appears completely or not at all.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/pictures/byte_image.hpp"
#include "base/pictures/float_image.hpp"

namespace clarity {

// The PNG encoder counts bytes in an int.
inline constexpr uint64_t kPngMaxPixels = 1u << 27;

// What a picture's file says besides its pixels.
struct PictureNotes {
    std::vector<std::pair<std::string, std::string>> texts;  // key, value in UTF-8; PNG and EXR keep them
    bool sync = false;                                       // wait for the disk before the file gets its name
};
// Notes that name the program and its version. denoised: and that the picture is biased by the denoiser.
PictureNotes picture_notes(bool denoised = false);

// Writes a picture in the format of the path's ending: .png from `display`; .exr or .pfm from `values` (1 or 3 channels; +inf
// and -1 are exact). Writes a temporary file in the same folder, then renames it. Throws Error(failed) with file and reason,
// and Error(usage) for another ending.
void write_image(const std::string& path, const FloatImage& values, const ByteImage& display, const PictureNotes& notes = {});

// Some channels of a file with several: "" for the colours, else the layer's name, as in "normal.X".
struct PictureLayer {
    std::string name;
    FloatImage values;  // 1 channel: NAME.Y; 3: R, G, B of colours, else NAME.X, NAME.Y, NAME.Z
};
// Writes layers of equal size into one EXR. Throws as write_image().
void write_layers(const std::string& path, const std::vector<PictureLayer>& layers, const PictureNotes& notes = {});
// Whether the path's ending is that of a format with layers.
bool holds_layers(const std::string& path);

// Whether write_image() uses `display` for this path. The other image may then be empty.
bool writes_display(const std::string& path);
// Throws Error(usage) if the ending is unknown or the folder is missing or not writable. Call it before any work.
void check_output_path(const std::string& path);

}  // namespace clarity
