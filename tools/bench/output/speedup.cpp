#include "tools/bench/output/speedup.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace clarity::bench {
namespace {

bool measured(const BenchRecord& record) {
    return record.status == RowStatus::ok && speed(record) > 0;
}

// True if whole pictures were timed: their speed is computed from wall time.
bool is_picture(const BenchRecord& record) {
    const std::string& m = record.measure;
    return m == "frame" || m == "whitted" || m == "picture" || m == "ranks" || m == "moving";
}

// The fastest row of a baseline; for builds, among those of comparable quality. nullptr: none was measured.
const BenchRecord* best_baseline(const std::vector<BenchRecord>& rows, const BenchRecord& ours) {
    const BenchRecord* best = nullptr;
    for (const BenchRecord& row : rows) {
        if (row.baseline.empty() || !measured(row)) continue;
        const bool is_built = row.measure == "build" || row.measure == "rebuild";
        if (is_built && row.baseline_quality != like_quality(ours.accel_params)) continue;
        if (!best || speed(row) > speed(*best)) best = &row;
    }
    return best;
}

}  // namespace

std::string like_quality(const std::string& accel) {
    std::istringstream words(accel);
    for (std::string word; std::getline(words, word, ',');) {
        if (word == "builder=morton") return "low";
        if (word == "builder=spatial") return "high";
    }
    return "medium";
}

bool is_build(const BenchRecord& record) {
    return record.measure == "build" || record.measure == "rebuild" || record.measure == "refit";
}

double speed(const BenchRecord& record) {
    if (is_build(record)) return record.mtris_per_s;
    return is_picture(record) ? record.fps : record.mrays_per_s;
}

double speed_spread(const BenchRecord& record) {
    return (is_picture(record) ? record.wall_ms : record.time_ms).spread();
}

Speedup speedup(const BenchRecord& row, const BenchRecord& other) {
    Speedup result;
    result.baseline = other.name();
    if (speed(other) <= 0) return result;
    result.ratio = speed(row) / speed(other);
    result.spread = std::hypot(speed_spread(row), speed_spread(other));
    return result;
}

bool about_same(double ratio, double spread) {
    return ratio > 0 && std::max(ratio, 1 / ratio) <= 1 + spread;
}

std::string ratio_text(double ratio, double spread, const char* same) {
    if (!(ratio > 0)) return {};
    if (about_same(ratio, spread)) return same;
    char text[16];
    std::snprintf(text, sizeof text, "%.2f", ratio);
    return text;
}

void compare_with_first(std::vector<BenchRecord>& rows) {
    for (size_t i = 1; i < rows.size(); ++i)
        if (measured(rows[i]) && measured(rows[0])) rows[i].speedup = speedup(rows[i], rows[0]);
}

void compare_with_baselines(std::vector<BenchRecord>& rows) {
    for (BenchRecord& row : rows) {
        if (!row.baseline.empty() || !measured(row)) continue;
        const BenchRecord* const best = best_baseline(rows, row);
        if (!best) continue;
        row.speedup = speedup(row, *best);
        if (best->accel_bytes > 0) row.speedup.bytes_ratio = double(row.accel_bytes) / double(best->accel_bytes);
    }
}

std::vector<SpeedupMean> speedup_means(const BenchReport& report) {
    std::vector<SpeedupMean> means;
    for (const BenchRecord& r : report.records) {
        if (r.speedup.baseline.empty() || r.status != RowStatus::ok) continue;
        auto* mean = const_cast<SpeedupMean*>(mean_of(means, r));
        if (!mean)
            mean = &means.emplace_back(SpeedupMean{r.suite, r.variant, r.device_id, r.measure, r.run, 0, 0, 0, {}, 0, 0});
        if (mean->rows == 0 || r.speedup.ratio < mean->least) {
            mean->least = r.speedup.ratio;
            mean->least_scene = r.scene;
            mean->least_spread = r.speedup.spread;
        }
        mean->mean += std::log(r.speedup.ratio);  // sum of logarithms until the second loop
        mean->mean_spread = std::hypot(mean->mean_spread, r.speedup.spread);
        ++mean->rows;
    }
    for (SpeedupMean& mean : means) {
        mean.mean = std::exp(mean.mean / mean.rows);
        mean.mean_spread /= mean.rows;
    }
    return means;
}

const SpeedupMean* mean_of(const std::vector<SpeedupMean>& means, const BenchRecord& r) {
    if (r.speedup.baseline.empty()) return nullptr;
    const auto found = std::find_if(means.begin(), means.end(), [&](const SpeedupMean& m) {
        return m.run == r.run && m.suite == r.suite && m.variant == r.variant && m.device_id == r.device_id &&
               m.measure == r.measure;
    });
    return found == means.end() ? nullptr : &*found;
}

}  // namespace clarity::bench
