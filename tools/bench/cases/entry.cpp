#include "tools/bench/cases/entry.hpp"

#include "base/error.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/run/failure.hpp"

namespace clarity::bench {

BenchRecord make_row(const BenchCase& c) {
    BenchRecord row;
    row.suite = c.suite;
    row.case_name = c.name;
    row.scene = c.name.substr(0, c.name.rfind('/'));
    row.measure = c.measure;
    return row;
}

void run_or_mark_failed(Entry& entry, const std::function<void(BenchRecord&)>& work) {
    if (entry.row.status != RowStatus::ok || !work) return;
    try {
        work(entry.row);
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& e) {
        // A setting which the device or structure does not support is no failure: the row is skipped.
        const auto* error = dynamic_cast<const Error*>(&e);
        entry.row.status = error && error->code() == Exit::usage ? RowStatus::skipped : RowStatus::failed;
        entry.row.why = failure_text(e);
    }
}

std::vector<BenchRecord> measured_rows(std::vector<Entry>& entries, bool is_timed, const MeasureRules& rules,
                                       Progress& progress) {
    std::vector<Contender> contenders;
    std::vector<BenchRecord*> rows;  // in the order of the contenders
    for (Entry& entry : entries) {
        if (!is_timed || entry.row.status != RowStatus::ok || !entry.once) continue;
        contenders.push_back({entry.row.variant, entry.once});
        rows.push_back(&entry.row);
    }
    const std::vector<Measured> measured = measure_interleaved(contenders, rules, progress);
    for (size_t i = 0; i < rows.size(); ++i) set_result(*rows[i], measured[i]);
    for (Entry& entry : entries) run_or_mark_failed(entry, entry.finish);
    std::vector<BenchRecord> finished;
    for (Entry& entry : entries) {
        set_rates(entry.row);
        finished.push_back(std::move(entry.row));
    }
    return finished;
}

void set_result(BenchRecord& row, const Measured& measured) {
    row.status = measured.status;
    row.why = measured.why;
    row.time_ms = measured.time_ms;
    row.wall_ms = measured.wall_ms;
    row.processors = measured.processors;
    if (measured.by_processor) row.clock = "processor";
}

void set_rates(BenchRecord& row) {
    if (row.status != RowStatus::ok) return;
    const double ms = row.time_ms.median;
    const bool builds = is_build(row);
    if (!builds && row.wall_ms.median > 0) row.fps = 1000 / row.wall_ms.median;
    if (builds) row.mtris_per_s = ms > 0 ? double(row.triangles) / ms / 1000 : 0;
    if (!builds && ms > 0) row.mrays_per_s = double(row.rays()) / ms / 1000;
}

}  // namespace clarity::bench
