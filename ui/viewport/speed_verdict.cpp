#include "ui/viewport/speed_verdict.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>

#include "base/statistics.hpp"
#include "ui/widgets/frame_graph.hpp"

namespace clarity::ui {

std::string speed_verdict(const std::vector<float>& mine, const std::vector<float>& others) {
    constexpr size_t kFewest = 5;
    if (std::min(mine.size(), others.size()) < kFewest) return {};
    // The 90th percentile of the faster side must be below the 10th percentile of the slower side. A single frame that another
    // program delayed then changes nothing.
    const auto beats = [](const std::vector<float>& a, const std::vector<float>& b) {
        return percentile(a, 0.9) < percentile(b, 0.1);
    };
    if (beats(others, mine)) return {};
    const double ratio = median({others.begin(), others.end()}) / std::max(median({mine.begin(), mine.end()}), 1e-9);
    if (!beats(mine, others) || ratio < 1.005) return kAboutTheSame;
    char text[64];
    std::snprintf(text, sizeof text, ratio < 10 ? "%.2f\u00d7 faster" : "%.0f\u00d7 faster", ratio);
    return text;
}

}  // namespace clarity::ui
