// devices_table.cpp -- pictures rendered by several devices, compared with those of the first device alone.
#include <cstdio>

#include "bench/baselines/speedup.hpp"
#include "bench/output/output.hpp"
#include "bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

double kernel_ms(const BenchRecord& r, const std::string& name) {
    for (const auto& [kernel, ms] : r.kernels_ms)
        if (kernel == name) return ms;
    return 0;
}

// Shares of the picture which the devices rendered, "0.510 0.490".
std::string shares(const BenchRecord& r) {
    std::string text;
    for (const auto& [name, share] : r.kernels_ms) {
        if (name.size() < 6 || name.compare(name.size() - 6, 6, " share") != 0) continue;
        char part[16];
        std::snprintf(part, sizeof part, "%s%.3f", text.empty() ? "" : " ", share);
        text += part;
    }
    return text;
}

}  // namespace

std::string devices_table(const BenchReport& report) {
    TextTable table({"scene", "", "shares", "picture ms", "traced ms", "tone map", "read-back", "spread %", "x the first"}, 3);
    for (const BenchRecord& r : report.records) {
        if ((r.measure != "picture" && r.measure != "moving") || r.status != RowStatus::ok) continue;
        char spread[16];
        std::snprintf(spread, sizeof spread, "%.1f", 100 * std::max(r.time_ms.spread(), r.wall_ms.spread()));
        table.add({r.scene, r.variant, shares(r), short_number(r.wall_ms.median), short_number(r.time_ms.median),
                   short_number(kernel_ms(r, "tone map")), short_number(kernel_ms(r, "read-back")), spread,
                   ratio_text(r.speedup.ratio, r.speedup.spread, "same")});
    }
    return table.empty() ? std::string()
                         : "devices: a picture with all its samples, from the call to the pixels on the host, p50, or one of "
                           "a hundred while the camera moves; kernels' times are the slowest device's\nsame: about the same, "
                           "the difference is within the measured spread\n" +
                               table.text(26) + "\n";
}

}  // namespace clarity::bench
