// report_bars.cpp -- bar charts.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bench/report/report_chart.hpp"
#include "bench/report/report_markup.hpp"

namespace clarity::bench {
namespace {

std::string css_percent(double share) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f%%", 100 * std::clamp(share, 0.0, 1.0));
    return text;
}

class Axis {
 public:
    explicit Axis(const BarChart& chart) {
        double least = INFINITY;
        const auto see = [&](double value) {
            if (!(value > 0) || !std::isfinite(value)) return;
            least = std::min(least, value);
            high_ = std::max(high_, value);
        };
        for (const BarGroup& group : chart.groups)
            for (const Bar& bar : group.bars) see(bar.value);
        see(chart.reference);
        log_ = least < INFINITY && high_ / least > 30 && chart.whole == 0;
        high_ = std::max(high_, chart.whole);
        if (log_) low_ = std::pow(10, std::floor(std::log10(least * .999)));
    }
    bool is_log() const { return log_; }
    double share(double value) const {
        if (!(value > 0) || !(high_ > 0) || !std::isfinite(value)) return 0;
        return log_ ? std::log(value / low_) / std::log(high_ / low_) : value / high_;
    }
    // At most six ticks, all within the axis.
    std::vector<double> ticks() const {
        std::vector<double> at;
        if (!(high_ > 0)) return at;
        if (log_) {
            const double decades = std::log10(high_ / low_), step = std::ceil(decades / 5);
            for (double power = 0; power <= decades; power += step) at.push_back(low_ * std::pow(10, power));
        } else {
            const double rough = high_ / 4, scale = std::pow(10, std::floor(std::log10(rough)));
            const double step = scale * (rough / scale > 5 ? 10 : rough / scale > 2 ? 5 : rough / scale > 1 ? 2 : 1);
            for (double value = 0; value <= high_; value += step) at.push_back(value);
        }
        return at;
    }

 private:
    bool log_ = false;
    double low_ = 0, high_ = 0;
};

// Width of the label column: the longest label, within limits.
std::string label_width(const BarChart& chart) {
    size_t longest = 0;
    for (const BarGroup& group : chart.groups)
        for (const Bar& bar : group.bars) longest = std::max(longest, bar.label.size());
    char text[32];
    std::snprintf(text, sizeof text, "%.1fem", std::clamp(.56 * double(longest) + 1, 4.5, 14.0));
    return text;
}

}  // namespace

std::string bar_chart(const BarChart& chart) {
    size_t bars = 0;
    for (const BarGroup& group : chart.groups) bars += group.bars.size();
    if (bars == 0) return {};
    const Axis axis(chart);
    const std::string line =
        chart.reference > 0 ? "<i class=\"ref\" style=\"left:" + css_percent(axis.share(chart.reference)) + "\"></i>" : "";

    std::string out =
        "<figure class=\"bars\" style=\"--label:" + label_width(chart) + "\"><figcaption>" + escape_markup(chart.title);
    out += " <small>" + escape_markup(chart.unit) + (axis.is_log() ? ", logarithmic" : "") + "</small>";
    if (chart.reference > 0) out += "<br/><small><i class=\"key\"></i> " + escape_markup(chart.reference_text) + "</small>";
    out += "</figcaption>\n";
    for (const BarGroup& group : chart.groups) {
        if (!group.title.empty())
            out += "<div class=\"row head\"><b>" + escape_markup(group.title) + "</b><span class=\"track\">" + line +
                   "</span></div>\n";
        for (const Bar& bar : group.bars) {
            const std::string width = css_percent(axis.share(bar.value));
            out += "<div class=\"row\"><span class=\"label\" title=\"" + escape_markup(bar.label) + "\">" +
                   escape_markup(bar.label) + "</span>";
            out += "<span class=\"track\" title=\"" + escape_markup(bar.hint) + "\">" + line;
            if (bar.value > 0)
                out += "<i class=\"bar c" + std::to_string(unsigned(bar.color) % kChartColors) + "\" style=\"width:" + width +
                       "\"></i>";
            out += "<span class=\"value\" style=\"left:" + width + "\">" +
                   escape_markup(bar.text.empty() ? figure(bar.value) : bar.text) + "</span></span></div>\n";
        }
    }
    out += "<div class=\"row axis\"><span></span><span class=\"track\">";
    for (const double tick : axis.ticks())
        out += "<span style=\"left:" + css_percent(axis.share(tick)) + "\">" + escape_markup(tick_figure(tick)) + "</span>";
    return out + "</span></div></figure>\n";
}

}  // namespace clarity::bench
