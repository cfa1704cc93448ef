#include "base/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clarity {
namespace {

double quantile(const std::vector<double>& sorted, double share) {
    const double at = share * double(sorted.size() - 1);
    const size_t below = static_cast<size_t>(std::floor(at));
    const size_t above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (at - double(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

Summary summarize(std::vector<double> values) {
    Summary summary;
    if (values.empty()) return summary;
    std::sort(values.begin(), values.end());
    summary.n = static_cast<unsigned>(values.size());
    summary.min = values.front();
    summary.max = values.back();
    summary.q1 = quantile(values, 0.25);
    summary.median = quantile(values, 0.5);
    summary.q3 = quantile(values, 0.75);
    summary.p95 = quantile(values, 0.95);
    summary.p99 = quantile(values, 0.99);
    return summary;
}

double median(std::vector<double> values) {
    return summarize(std::move(values)).median;
}

double normal_of_chi_square(double chi_square, double degrees) {
    const double k = 2 / (9 * degrees);
    return (std::cbrt(chi_square / degrees) - (1 - k)) / std::sqrt(k);
}

}  // namespace clarity
