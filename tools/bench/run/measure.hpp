// measure.hpp -- times contenders interleaved (A B A B), so that a disturbance of the machine affects all of them alike.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "tools/bench/output/record.hpp"

namespace clarity::bench {

// One repetition of a contender. Times are in ms.
struct Sample {
    double time_ms = 0;  // by the device's clock
    double wall_ms = 0;  // by the host's
    // Of all threads of this process, while it did what time_ms is of; 0: it is not what time_ms is of, as on a GPU.
    double processor_ms = 0;

    // Of a contender that tunes itself (tracers/rays/autotuner.hpp):
    bool trial = false;    // this repetition tried one of several variants: its time does not count, and it is repeated
    bool settled = true;   // a variant is chosen: the warm-up may end
    unsigned variant = 0;  // index of the variant; samples of other variants than the last one are dropped
};

struct Contender {
    std::string name;              // for messages
    std::function<Sample()> once;  // runs one repetition. If it throws, the contender is out and the others go on
};

struct MeasureRules {
    bool by_processor = false;  // time_ms is Sample::processor_ms where that is known, and wall_ms is left out
    double budget_s = 10;       // for all contenders of a case together, warm-up included
    double goal_spread = .01;   // stop early once all spreads are at most this
    double max_spread = .1;     // attempts with a larger spread are repeated, and finally refused
    unsigned min_rounds = 9;    // wanted; fewer if the budget is too short
    unsigned few_rounds = 3;    // the least that count as a result
    unsigned max_rounds = 51;
    unsigned retries = 2;  // further attempts if a contender is refused
};

struct Measured {
    RowStatus status = RowStatus::ok;
    std::string why;  // reason, unless status is ok
    Summary time_ms, wall_ms;
    bool by_processor = false;  // time_ms is of processors
    double processors = 0;      // that this process kept busy, median: 1.0 where one of two threads waits; 0: not known
    double spread() const;      // the larger one of both
};

// Results in the order of the contenders. Throws Cancelled.
std::vector<Measured> measure_interleaved(const std::vector<Contender>& contenders, const MeasureRules& rules,
                                          Progress& progress);

}  // namespace clarity::bench
