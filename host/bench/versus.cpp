#include "bench/versus.hpp"

#include <algorithm>
#include <cmath>

namespace clarity {
namespace {

bool measured(const BenchRecord& record) {
    return record.status == RowStatus::ok && speed(record) > 0;
}

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// The fastest row of a peer; of builds, of one quality. nullptr: none was measured.
const BenchRecord* best_peer(const std::vector<BenchRecord>& rows, const BenchRecord& ours) {
    const BenchRecord* best = nullptr;
    for (const BenchRecord& row : rows) {
        if (row.peer.empty() || !measured(row)) continue;
        if (row.measure == "build" && !ends_with(row.peer, " " + like_quality(ours.accel_params))) continue;
        if (!best || speed(row) > speed(*best)) best = &row;
    }
    return best;
}

}  // namespace

std::string like_quality(const std::string& accel) {
    if (accel.find("builder=morton") != std::string::npos) return "low";
    return accel.find("builder=spatial") != std::string::npos ? "high" : "medium";
}

double speed(const BenchRecord& record) {
    if (record.measure == "build") return record.mtris_per_s;
    const bool whole = record.measure == "frame" || record.measure == "whitted" || record.measure == "picture";
    return whole ? record.fps : record.mrays_per_s;
}

void compare_with_peers(std::vector<BenchRecord>& rows) {
    for (BenchRecord& row : rows) {
        if (!row.peer.empty() || !measured(row)) continue;
        const BenchRecord* const best = best_peer(rows, row);
        if (!best) continue;
        row.versus.peer = best->peer;
        row.versus.ratio = speed(row) / speed(*best);
        if (best->accel_bytes > 0) row.versus.bytes_ratio = double(row.accel_bytes) / double(best->accel_bytes);
    }
}

std::vector<VersusMean> versus_means(const BenchReport& report) {
    std::vector<VersusMean> means;
    for (const BenchRecord& r : report.records) {
        if (r.versus.peer.empty() || r.status != RowStatus::ok) continue;
        auto* mean = const_cast<VersusMean*>(mean_of(means, r));
        if (!mean) mean = &means.emplace_back(VersusMean{r.suite, r.variant, r.device_id, r.measure, r.run, 0, 0, 0, {}});
        if (mean->rows == 0 || r.versus.ratio < mean->least) {
            mean->least = r.versus.ratio;
            mean->least_scene = r.scene;
        }
        mean->mean += std::log(r.versus.ratio);  // a sum of logarithms until all are in
        ++mean->rows;
    }
    for (VersusMean& mean : means) mean.mean = std::exp(mean.mean / mean.rows);
    return means;
}

const VersusMean* mean_of(const std::vector<VersusMean>& means, const BenchRecord& r) {
    if (r.versus.peer.empty()) return nullptr;
    const auto found = std::find_if(means.begin(), means.end(), [&](const VersusMean& m) {
        return m.run == r.run && m.suite == r.suite && m.variant == r.variant && m.device_id == r.device_id &&
               m.measure == r.measure;
    });
    return found == means.end() ? nullptr : &*found;
}

}  // namespace clarity
