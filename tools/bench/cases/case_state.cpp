#include "tools/bench/cases/case_state.hpp"

#include <cmath>
#include <cstdio>

namespace clarity::bench {
namespace {

// Share of rays that may hit something else than in the first row: rays at silhouettes, where rounding decides.
constexpr double kMayDiffer = 1e-3;
// Share of pixels of the baselines' frame which may differ, and from which difference on a pixel counts. The limit is larger
// than for rays, because five generations of mirrors magnify every difference.
constexpr double kPixelsMayDiffer = 1e-2;
constexpr float kPixelMayDiffer = 0.02f;

}  // namespace

void Agreement::check_hits(BenchRecord& row, const RaySet& set, const std::vector<float>& distances) {
    uint64_t differ = 0;
    for (size_t i = 0; i < set.rays.size(); ++i) {
        if (!is_active(set.rays[i])) continue;
        const float t = distances[i];
        if (std::isfinite(t)) ++row.hits;
        if (reference_hits_.empty()) continue;
        const float other = reference_hits_[i];
        const bool same =
            std::isfinite(t) == std::isfinite(other) && (!std::isfinite(t) || std::fabs(t - other) <= 1e-3f * other);
        if (!same) ++differ;
    }
    if (reference_hits_.empty()) reference_hits_ = distances;
    if (double(differ) <= kMayDiffer * double(set.active)) return;
    row.status = RowStatus::refused;
    row.why = "its answers differ from those of the first row for " + std::to_string(differ) + " of " +
              std::to_string(set.active) + " rays: one of the two is wrong, `ctest -R conformance` says which";
}

void Agreement::check_picture(BenchRecord& row, FloatImage picture) {
    if (reference_picture_.pixels.empty()) {
        reference_picture_ = std::move(picture);
        return;
    }
    const double differ = differing_pixels(picture, reference_picture_, kPixelMayDiffer);
    if (differ <= kPixelsMayDiffer) return;
    char why[160];
    std::snprintf(why, sizeof why, "%.2g %% of its pixels differ from the first row's by more than %g: one of the two is wrong",
                  100 * differ, double(kPixelMayDiffer));
    row.status = RowStatus::refused;
    row.why = why;
}

void Agreement::check_sequence(BenchRecord& row, uint64_t digest, bool overlapped) {
    uint64_t& expected = one_by_one_[structure_and_device(row)];
    if (!overlapped) {
        expected = digest;
    } else if (digest != expected) {
        row.status = RowStatus::refused;
        row.why = "its pictures differ from those which are copied one by one: one of the two is wrong";
    }
}

std::string structure_and_device(const BenchRecord& row) {
    return row.accel + " " + row.accel_params + " " + row.device_id;
}

}  // namespace clarity::bench
