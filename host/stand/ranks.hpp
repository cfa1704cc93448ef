// ranks.hpp -- several processes that render one picture together, each with devices of its own. Rank 0 has the whole picture
// at the end.
#pragma once
#include <cstddef>
#include <cstdint>
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
    // To rank 0, which receives from each of the others in turn. Both know the size in bytes.
    virtual void send(const void* data, uint64_t bytes) = 0;
    virtual void receive(unsigned from, void* data, uint64_t bytes) = 0;
};

// How many of `tiles` each of several workers gets, in proportion to their speeds: for each tile the number of its worker.
// Every worker gets tiles from all parts of the picture.
std::vector<unsigned> deal_tiles(unsigned tiles, const std::vector<double>& speeds);

// Rows of pixels, consecutive.
struct PixelRows {
    unsigned first = 0, count = 0;
};
// Brings the rows of other ranks into the picture of rank 0, without a copy on the way: those of a large picture take longer to
// copy than to trace. mine: the rows that this rank has traced. picture: row_bytes for each row.
void collect_rows(Ranks& ranks, const std::vector<PixelRows>& mine, size_t row_bytes, unsigned height, char* picture);

}  // namespace clarity
