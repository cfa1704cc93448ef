// bands.hpp -- rows of work-groups as rows of pixels.
#pragma once
#include <CL/opencl.hpp>
#include <vector>

#include "rt_types.h"

namespace clarity {

struct Band {
    unsigned first = 0, count = 0;  // rows of pixels
};

// rows: of work-groups, each `row_height` pixels high, in any order. Neighbours become one band; from the top down.
std::vector<Band> bands_of(const std::vector<rt_u32>& rows, unsigned row_height, unsigned height);

// Enqueues copies of these rows of a picture, each from and to its place: bands at even distances together, since a copy costs
// a GPU's driver 6 us. events: what was enqueued.
void read_bands(cl::CommandQueue& queue, const cl::Buffer& from, const std::vector<Band>& bands, size_t row_bytes, void* to,
                std::vector<cl::Event>* events = nullptr);

}  // namespace clarity
