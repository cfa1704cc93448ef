// ranks.hpp -- several processes that render one picture together, each with devices of its own. Rank 0 has the whole picture
// at the end.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace clarity {

// All ranks call the same functions in the same order, from one thread each. A function returns when the others have come so
// far that it can. Functions throw Error(failed).
class Ranks {
 public:
    virtual ~Ranks() = default;
    virtual unsigned rank() const = 0;   // of this process, from 0
    virtual unsigned count() const = 0;  // of processes
    // Each rank gives a number. Returns those of all, in the order of ranks.
    virtual std::vector<double> gather(double mine) = 0;
    // Rank 0 gets what the others give: take(rank, bytes), one after the other.
    virtual void collect(const std::string& mine, const std::function<void(unsigned, const std::string&)>& take) = 0;
};

// How many of `tiles` each of several workers gets, in proportion to their speeds: for each tile the number of its worker.
// Every worker gets tiles from all parts of the picture.
std::vector<unsigned> deal_tiles(unsigned tiles, const std::vector<double>& speeds);

// Rows of pixels, consecutive.
struct PixelRows {
    unsigned first = 0, count = 0;
};
// Copies the rows of other ranks into the picture of rank 0. mine: the rows that this rank has traced. picture: row_bytes for
// each row.
void collect_rows(Ranks& ranks, const std::vector<PixelRows>& mine, size_t row_bytes, unsigned height, char* picture);

}  // namespace clarity
