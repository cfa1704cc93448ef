// agreement.hpp -- checks that all rows of a case compute the same. A row with other results does not trace the same scene,
// so that comparing times would mean nothing: it is refused.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "bench/baselines/whitted.hpp"
#include "bench/output/record.hpp"
#include "bench/suites/ray_sets.hpp"
#include "render/film/image_io.hpp"

namespace clarity::bench {

class Agreement {
 public:
    // Compares hit distances (one per ray, +inf for a miss) with those of the first row that is checked, and counts the row's
    // hits.
    void check_hits(BenchRecord& row, const RaySet& set, const std::vector<float>& distances);
    // Compares a picture with that of the first row that is checked.
    void check_picture(BenchRecord& row, FloatImage picture);
    // Compares the digest of an overlapped sequence of pictures with that of the non-overlapped sequence of the same structure
    // and device, which is to be checked first.
    void check_sequence(BenchRecord& row, uint64_t digest, bool overlapped);

 private:
    std::vector<float> reference_hits_;
    FloatImage reference_picture_;
    std::map<std::string, uint64_t> one_by_one_;  // digests of the non-overlapped sequences, by structure_and_device()
};

// Key of a row's structure and device: rows of a case with equal keys differ only in how pictures are copied to the host.
std::string structure_and_device(const BenchRecord& row);

}  // namespace clarity::bench
