#include "stand/ranks.hpp"

#include <algorithm>
#include <numeric>
#include <string>

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
    const std::vector<double> counts = ranks.gather(double(mine.size()));
    if (ranks.rank() != 0) {
        ranks.send(mine.data(), mine.size() * sizeof(PixelRows));
        for (const PixelRows& rows : mine) ranks.send(picture + rows.first * row_bytes, rows.count * row_bytes);
        return;
    }
    for (unsigned rank = 1; rank < ranks.count(); ++rank) {
        std::vector<PixelRows> theirs(static_cast<size_t>(counts[rank]));
        ranks.receive(rank, theirs.data(), theirs.size() * sizeof(PixelRows));
        for (const PixelRows& rows : theirs)
            if (rows.first > height || rows.count > height - rows.first)
                throw Error(Exit::failed,
                            "rank " + std::to_string(rank) +
                                " sent rows that are not of this picture: do all ranks run the same version of the "
                                "program?");
        for (const PixelRows& rows : theirs) ranks.receive(rank, picture + rows.first * row_bytes, rows.count * row_bytes);
    }
}

}  // namespace clarity
