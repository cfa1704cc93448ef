// bands.hpp -- converts rows of work-groups to rows of pixels, and copies these.
#pragma once
#include <CL/opencl.hpp>
#include <vector>

#include "device/queue.hpp"
#include "kernels/layout.hpp"
#include "rt_types.h"

namespace clarity {

// Consecutive rows of pixels.
struct Band {
    unsigned first = 0, count = 0;  // in rows of pixels
};

// The rows of work-groups of a picture that one device traces.
struct GroupRows {
    unsigned width, height;           // of the whole picture, pixels
    unsigned row_height;              // of one row of work-groups, pixels
    const std::vector<rt_u32>& rows;  // numbers of the rows, in any order
    // Pixels in one row of work-groups, including those beyond the bottom of the picture.
    size_t row_pixels() const { return size_t(width) * row_height; }
    // Pixels inside the picture in rows[first] and all entries after it.
    uint64_t pixels(size_t first = 0) const;
    // The same rows as rows of pixels, from the top down. Adjacent rows form one band.
    std::vector<Band> bands() const;
};

// Enqueues copies of these bands of a picture; each keeps its position. `row_bytes` is the size of a row of pixels. Bands at
// equal distances share one copy, because each copy costs a GPU's driver 6 us. If given, `events` gets the event of each copy.
void read_bands(Queue& queue, const cl::Buffer& from, const std::vector<Band>& bands, size_t row_bytes, void* to,
                std::vector<cl::Event>* events = nullptr);

}  // namespace clarity
