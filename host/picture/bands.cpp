#include "picture/bands.hpp"

#include <algorithm>

namespace clarity {

uint64_t GroupRows::pixels(size_t first) const {
    uint64_t sum = 0;
    for (size_t i = first; i < rows.size(); ++i) sum += uint64_t(width) * std::min(row_height, height - rows[i] * row_height);
    return sum;
}

std::vector<Band> GroupRows::bands() const {
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

namespace {

// Bands of equal height at equal distances, in rows of pixels; `band` is the first one.
struct Row {
    Band band;
    unsigned step = 0;
};

// How many bands ahead we look for the second band of a row. Devices that share a picture alternate with about this period.
constexpr unsigned kMostSteps = 16;

// Finds the longest row that begins with bands[first] and uses no taken band. `in_row` gets the indices of its bands.
Row longest_row(const std::vector<Band>& bands, const std::vector<bool>& taken, size_t first, std::vector<size_t>& in_row) {
    Row best{bands[first]};
    in_row = {first};
    std::vector<size_t> tried;
    unsigned steps = 0;
    for (size_t second = first + 1; second < bands.size() && steps < kMostSteps; ++second, ++steps) {
        const unsigned step = bands[second].first - bands[first].first;
        tried = {first};
        for (size_t next = second; next < bands.size(); ++next) {
            const unsigned wanted = bands[tried.back()].first + step;
            if (bands[next].first > wanted) break;
            if (bands[next].first == wanted && bands[next].count == best.band.count && !taken[next]) tried.push_back(next);
        }
        if (tried.size() > in_row.size()) {
            in_row = tried;
            best.step = step;
        }
    }
    return best;
}

}  // namespace

void read_bands(Queue& queue, const cl::Buffer& from, const std::vector<Band>& bands, size_t row_bytes, void* to,
                std::vector<cl::Event>* events) {
    const size_t all_bytes = from.getInfo<CL_MEM_SIZE>();
    std::vector<bool> taken(bands.size());
    std::vector<size_t> in_row;
    for (size_t first = 0; first < bands.size(); ++first) {
        if (taken[first]) continue;
        const Row row = longest_row(bands, taken, first, in_row);
        const size_t at = row.band.first * row_bytes, bytes = row.band.count * row_bytes, pitch = row.step * row_bytes;
        // Some drivers require that every pitch of the region lies completely inside the buffer.
        while (in_row.size() > 1 && (at % pitch + bytes > pitch || (at / pitch + in_row.size()) * pitch > all_bytes))
            in_row.pop_back();
        for (const size_t i : in_row) taken[i] = true;
        cl::Event event;
        cl::Event* const done = events ? &event : nullptr;
        if (in_row.size() == 1) {
            queue.enqueueReadBuffer(from, CL_FALSE, at, bytes, static_cast<char*>(to) + at, nullptr, done);
        } else {
            const cl::array<cl::size_type, 3> origin = {at % pitch, at / pitch, 0}, region = {bytes, in_row.size(), 1};
            queue.enqueueReadBufferRect(from, CL_FALSE, origin, origin, region, pitch, 0, pitch, 0, to, nullptr, done);
        }
        if (events) events->push_back(event);
    }
}

}  // namespace clarity
