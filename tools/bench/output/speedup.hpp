// speedup.hpp -- our speed divided by the fastest baseline's in the same case, and its mean over all scenes.
#pragma once
#include <string>
#include <vector>

#include "tools/bench/output/record.hpp"

namespace clarity::bench {

// The quality of a baseline's build which is comparable to ours: "low" for builder=morton (space-filling curve), "high" for
// builder=spatial (spatial splits), else "medium" (surface area heuristic). accel: "bvh8,builder=morton", or the parameters
// alone.
std::string like_quality(const std::string& accel);

// The speed of a row: million triangles a second for builds, frames a second for pictures, million rays a second for rays. 0:
// not measured.
double speed(const BenchRecord& record);
// True for rows that make a structure: their speed is in triangles a second.
bool is_build(const BenchRecord& record);

// Relative spread of the times from which speed() is computed.
double speed_spread(const BenchRecord& record);

// Speed of `row` divided by that of `other`; both must be measured. The spread of the ratio is the root of the sum of both
// rows' squared spreads.
Speedup speedup(const BenchRecord& row, const BenchRecord& other);

// True if the ratio differs from 1 by no more than the measured spread, so that neither row can be called faster. False for the
// ratio 0, which means that nothing was compared.
bool about_same(double ratio, double spread);
// "1.23"; "" for 0; `same` if the two are about the same.
std::string ratio_text(double ratio, double spread, const char* same);

// Sets `speedup` of our rows of one case. A build is compared with the baselines' builds of like_quality(), everything else
// with the fastest row of any baseline.
void compare_with_baselines(std::vector<BenchRecord>& rows);

// Sets `speedup` of all rows but the first, which they are compared with.
void compare_with_first(std::vector<BenchRecord>& rows);

// Speed-up of one structure on one device over the scenes of a suite.
struct SpeedupMean {
    std::string suite, variant, device_id, measure;
    size_t run = 0;
    unsigned rows = 0;
    double mean = 0;          // geometric mean of the ratios
    double least = 0;         // smallest ratio
    std::string least_scene;  // scene of the smallest ratio
    double mean_spread = 0;   // spread of the mean, from the spreads of the rows
    double least_spread = 0;  // spread of the smallest ratio
};
// Means in the order in which their first rows occur.
std::vector<SpeedupMean> speedup_means(const BenchReport& report);
// The mean to which a record belongs; nullptr if the record has no baseline.
const SpeedupMean* mean_of(const std::vector<SpeedupMean>& means, const BenchRecord& record);

}  // namespace clarity::bench
