// checkpoint.hpp -- a file from which a picture goes on after its process was killed.
//
// Layout, all numbers little endian: 8 bytes "ClCheck1"; 8 bytes: length of the head; the head, JSON; the film, 4 floats a
// pixel, top row first: sums of r, g and b, and the number of samples; more planes of the film, if the head says so; 32 digits:
// digest (base/digest.hpp) of all before them.
#pragma once
#include <memory>
#include <string>

#include "base/pictures/image_io.hpp"

namespace clarity {

struct Checkpoint {
    std::string picture;  // digest of all that the picture depends on
    // How it is traced: device, structure, tracer, kernels. With another one the picture goes on, but its last bits may differ.
    std::string way;
    unsigned samples = 0, of = 0;            // complete samples of each pixel, and those of the whole picture
    unsigned planes = 1;                     // of the film
    std::shared_ptr<const FloatImage> sums;  // 4 channels; the rows of all planes
};

// Writes the file whole or not at all: a process that is killed at any moment leaves the old one or the new one, also if the
// power fails. Throws Error(failed) with the file and the reason.
void save_checkpoint(const std::string& path, const Checkpoint& checkpoint);
// Reads a file and checks every bit of it. Throws Error(failed), which says why the file is none, or damaged.
Checkpoint load_checkpoint(const std::string& path);

}  // namespace clarity
