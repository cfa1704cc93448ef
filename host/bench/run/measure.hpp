// measure.hpp -- contenders that are to be compared, timed turn by turn: A B A B, so that what disturbs the machine for a while
// disturbs all of them alike.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "bench/output/record.hpp"

namespace clarity::bench {

// One repetition.
struct Sample {
    double time_ms = 0;  // by the device's clock
    double wall_ms = 0;  // by the host's

    // Of a contender that tunes itself (render/faster_way.hpp):
    bool trial = false;   // a try of one of several ways: the time does not count, and the repetition is done again
    bool settled = true;  // the way is chosen: the warm-up may end
    unsigned way = 0;     // the number of the way; samples of another way than the last one's are dropped
};

struct Contender {
    std::string name;              // for messages
    std::function<Sample()> once;  // may throw Error: the contender is out, the others go on
};

struct MeasureRules {
    double budget_s = 10;      // for all contenders of a case together, warm-up included
    double goal_spread = .01;  // at which enough is enough
    double max_spread = .1;    // above it the case is measured anew, and in the end refused
    unsigned min_rounds = 9;   // wanted; fewer where the budget does not hold them
    unsigned few_rounds = 3;   // demanded
    unsigned max_rounds = 51;
    unsigned retries = 2;  // of a case with a refused contender
};

struct Measured {
    RowStatus status = RowStatus::ok;
    std::string why;  // unless ok
    Summary time_ms, wall_ms;
    double spread() const;  // the larger of the two
};

// In the order of the contenders. Throws Cancelled.
std::vector<Measured> measure_interleaved(const std::vector<Contender>& contenders, const MeasureRules& rules,
                                          Progress& progress);

}  // namespace clarity::bench
