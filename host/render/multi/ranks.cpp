#include "render/multi/ranks.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "base/error.hpp"

namespace clarity {

std::vector<unsigned> deal_tiles(unsigned tiles, const std::vector<double>& speeds) {
    const double sum = std::accumulate(speeds.begin(), speeds.end(), 0.0);
    std::vector<double> owed(speeds.size(), 0.0);
    std::vector<unsigned> worker_of;
    for (unsigned tile = 0; tile < tiles; ++tile) {
        for (size_t i = 0; i < speeds.size(); ++i) owed[i] += sum > 0 ? speeds[i] / sum : 1.0 / double(speeds.size());
        const auto most = std::max_element(owed.begin(), owed.end());
        *most -= 1;
        worker_of.push_back(static_cast<unsigned>(most - owed.begin()));
    }
    return worker_of;
}

void collect_rows(Ranks& ranks, const std::vector<PixelRows>& mine, size_t row_bytes, unsigned height, char* picture) {
    std::string bytes;
    if (ranks.rank() != 0)
        for (const PixelRows& rows : mine) {
            bytes.append(reinterpret_cast<const char*>(&rows), sizeof rows);
            bytes.append(picture + rows.first * row_bytes, rows.count * row_bytes);
        }
    ranks.collect(bytes, [&](unsigned rank, const std::string& given) {
        for (size_t at = 0; at < given.size();) {
            PixelRows rows;
            if (given.size() - at >= sizeof rows) std::memcpy(&rows, &given[at], sizeof rows);
            at += sizeof rows;
            if (rows.first > height || rows.count > height - rows.first || rows.count == 0 ||
                given.size() < at + rows.count * row_bytes)
                throw Error(Exit::failed, "rank " + std::to_string(rank) +
                                              " sent rows that are not of this picture: do all "
                                              "ranks run the same version of the program?");
            std::memcpy(picture + rows.first * row_bytes, &given[at], rows.count * row_bytes);
            at += rows.count * row_bytes;
        }
    });
}

}  // namespace clarity
