// policy_table.cpp -- animations of 200 frames, refitted and built by one rule after another.
#include <cstdio>

#include "bench/output/output.hpp"
#include "bench/output/record_fields.hpp"
#include "bench/output/text_table.hpp"

namespace clarity::bench {

std::string policy_table(const BenchReport& report) {
    TextTable table(
        {"scene", "animation", "", "triangles", "total ms", "updates", "traced", "builds", "worst SAH", "x the best"}, 3);
    for (const BenchRecord& r : report.records) {
        if (r.suite != "policy" || r.status != RowStatus::ok) continue;
        char to_best[16];
        std::snprintf(to_best, sizeof to_best, "%.3f", r.animation.to_best);
        table.add({r.scene, r.case_name.substr(r.case_name.rfind('/') + 1), r.name(), std::to_string(r.triangles),
                   short_number(r.animation.total_ms), short_number(r.animation.update_ms), short_number(r.animation.trace_ms),
                   std::to_string(r.animation.builds), short_number(r.animation.worst_cost_ratio), to_best});
    }
    return table.empty()
               ? std::string()
               : "policy: 200 frames of an animation, ms of all of them; x the best: total, divided by that of the best "
                 "fixed rule\n" +
                     table.text(28) + "\n";
}

}  // namespace clarity::bench
