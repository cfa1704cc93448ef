// moving_table.cpp -- models whose vertices all move: refits and builds, and the rays that are traced after either.
#include <cstdio>

#include "bench/baselines/speedup.hpp"
#include "bench/output/output.hpp"
#include "bench/output/record_fields.hpp"
#include "bench/output/text_table.hpp"

namespace clarity::bench {

std::string moving_table(const BenchReport& report) {
    TextTable table({"scene", "motion", "", "triangles", "ms", "Mtri/s", "Mrays/s", "B/tri", "SAH", "spread %", "x baseline",
                     "pose", "deform", "update", "trace", "fps"},
                    3);
    const auto part = [](const BenchRecord& r, const char* name) {
        for (const auto& [part, ms] : r.kernels_ms)
            if (part == name) return short_number(ms);
        return std::string();
    };
    for (const BenchRecord& r : report.records) {
        if (r.suite != "moving" || r.status != RowStatus::ok) continue;
        char spread[16];
        std::snprintf(spread, sizeof spread, "%.1f", 100 * r.time_ms.spread());
        table.add({r.scene, r.case_name.substr(r.case_name.rfind('/') + 1), r.name(), std::to_string(r.triangles),
                   short_number(r.time_ms.median), short_number(r.mtris_per_s), short_number(r.mrays_per_s),
                   short_number(r.bytes_per_triangle), short_number(r.sah_cost), spread,
                   ratio_text(r.speedup.ratio, r.speedup.spread, "same"), part(r, "pose"), part(r, "deform"), part(r, "update"),
                   part(r, "trace"), r.rays() == 0 && r.mtris_per_s == 0 ? short_number(r.fps) : std::string()});
    }
    return table.empty()
               ? std::string()
               : "moving: a refit or a build from vertices in place to the finished structure; a whole frame, with its "
                 "parts in ms; p50\n" +
                     table.text(26) + "\n";
}

}  // namespace clarity::bench
