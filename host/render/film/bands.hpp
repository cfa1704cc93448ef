// bands.hpp -- rows of work-groups as rows of pixels.
#pragma once
#include <CL/opencl.hpp>
#include <vector>

#include "render/kernels/layout.hpp"
#include "rt_types.h"

namespace clarity {

struct Band {
    unsigned first = 0, count = 0;  // rows of pixels
};

// Those rows of work-groups of a picture that one device has.
struct GroupRows {
    unsigned width, height;           // of the whole picture, pixels
    unsigned row_height;              // of one row of work-groups, pixels
    const std::vector<rt_u32>& rows;  // their numbers, in any order
    // Pixels of a row of work-groups that the picture does not cut off.
    size_t row_pixels() const { return size_t(width) * row_height; }
    // Pixels of the picture in rows[first] and those after it.
    uint64_t pixels(size_t first = 0) const;
    // The same as rows of pixels, from the top down. Neighbours become one band.
    std::vector<Band> bands() const;
};

// Enqueues copies of these rows of a picture, each from and to its place: bands at even distances together, since a copy costs
// a GPU's driver 6 us. events: what was enqueued.
void read_bands(cl::CommandQueue& queue, const cl::Buffer& from, const std::vector<Band>& bands, size_t row_bytes, void* to,
                std::vector<cl::Event>* events = nullptr);

}  // namespace clarity
