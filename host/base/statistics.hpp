// statistics.hpp -- repeated measurements of one quantity, summed up so that a few disturbed ones do not matter.
#pragma once
#include <vector>

namespace clarity {

struct Summary {
    double median = 0, q1 = 0, q3 = 0, min = 0, max = 0;  // the median is called p50 wherever a person reads it
    unsigned n = 0;                                       // 0: not measured
    double p95 = 0, p99 = 0;                              // 0: not known, as in records of earlier versions
    // Relative spread: the middle half's width by the median. 0 for fewer than two measurements.
    double spread() const { return n > 1 && median > 0 ? (q3 - q1) / median : 0; }
};

// Quartiles and percentiles by linear interpolation between the sorted values (Hyndman and Fan 1996, Sample Quantiles in
// Statistical Packages, definition 7).
Summary summarize(std::vector<double> values);

// The mean of the middle two of an even number; 0 of none.
double median(std::vector<double> values);

}  // namespace clarity
