#include "render/bands.hpp"

#include <algorithm>

namespace clarity {

std::vector<Band> bands_of(const std::vector<rt_u32>& rows, unsigned row_height, unsigned height) {
    std::vector<rt_u32> sorted = rows;
    std::sort(sorted.begin(), sorted.end());
    std::vector<Band> bands;
    for (const rt_u32 row : sorted) {
        const unsigned first = row * row_height, count = std::min(row_height, height - first);
        if (!bands.empty() && bands.back().first + bands.back().count == first)
            bands.back().count += count;
        else
            bands.push_back({first, count});
    }
    return bands;
}

void read_bands(cl::CommandQueue& queue, const cl::Buffer& from, const std::vector<Band>& bands, size_t row_bytes, void* to,
                std::vector<cl::Event>* events) {
    for (const Band& band : bands) {
        const size_t at = band.first * row_bytes;
        cl::Event event;
        queue.enqueueReadBuffer(from, CL_FALSE, at, band.count * row_bytes, static_cast<char*>(to) + at, nullptr,
                                events ? &event : nullptr);
        if (events) events->push_back(event);
    }
}

}  // namespace clarity
