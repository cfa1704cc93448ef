// statistics.hpp -- robust statistics of repeated measurements: a few disturbed ones do not matter.
#pragma once
#include <vector>

namespace clarity {

struct Summary {
    double median = 0, q1 = 0, q3 = 0, min = 0, max = 0;  // outputs call the median p50
    unsigned n = 0;                                       // 0: not measured
    double p95 = 0, p99 = 0;                              // 0: not known, as in records of earlier versions
    // Relative spread: the interquartile range divided by the median. 0 for fewer than two measurements.
    double spread() const { return n > 1 && median > 0 ? (q3 - q1) / median : 0; }
};

// Computes quartiles and percentiles by linear interpolation between the sorted values (Hyndman and Fan 1996, Sample Quantiles
// in Statistical Packages, definition 7).
Summary summarize(std::vector<double> values);

// The median; for an even number of values the mean of the middle two. 0 if there are none.
double median(std::vector<double> values);

// A random number of a standard normal distribution that is as unlikely as a chi-square of `degrees` degrees (Wilson, Hilferty
// 1931).
double normal_of_chi_square(double chi_square, double degrees);

}  // namespace clarity
