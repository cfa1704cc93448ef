// speedup.hpp -- ours by the best of the peers in the same case, and what comes out over all scenes.
#pragma once
#include <string>
#include <vector>

#include "bench/output/record.hpp"

namespace clarity::bench {

// The quality of a peer's build that is as quick or as thorough as ours: by a curve, by the heuristic, or with spatial splits.
// accel: "bvh8,builder=morton", or the parameters alone.
std::string like_quality(const std::string& accel);

// What a row is fast by: triangles (build), frames or rays a second. 0: it was not measured.
double speed(const BenchRecord& record);

// The relative spread of the times that speed() is made of.
double speed_spread(const BenchRecord& record);

// How many times as fast `row` is as `other`, both measured. The spread of the ratio is that of the two rows together: the root
// of the sum of their squares.
Speedup speedup(const BenchRecord& row, const BenchRecord& other);

// True if the two differ by no more than the measured spread, so that neither can be called faster. A ratio of 0, which says
// that nothing was compared, is not the same.
bool about_same(double ratio, double spread);
// "1.23", "" for 0, and `same` where they are about the same.
std::string ratio_text(double ratio, double spread, const char* same);

// Fills in `versus` of our rows of one case. A build is compared with the peers' builds of its kind (builder=morton: low
// quality, spatial: high, else medium), everything else with the fastest row of any peer.
void compare_with_baselines(std::vector<BenchRecord>& rows);

// Of one structure on one device, over the scenes of a suite.
struct SpeedupMean {
    std::string suite, variant, device_id, measure;
    size_t run = 0;
    unsigned rows = 0;
    double mean = 0;          // geometric
    double least = 0;         // and
    std::string least_scene;  // where
    double mean_spread = 0;   // of the mean, from the spreads of the rows
    double least_spread = 0;
};
// In the order in which they first come.
std::vector<SpeedupMean> speedup_means(const BenchReport& report);
// nullptr if the record has no peer.
const SpeedupMean* mean_of(const std::vector<SpeedupMean>& means, const BenchRecord& record);

}  // namespace clarity::bench
