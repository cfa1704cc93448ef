#include "ui/viewport/picture_captions.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "base/numbers.hpp"
#include "ui/session/session_output.hpp"
#include "ui/widgets/plots.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

// Turns a label into the form used within a sentence: "max leaf size", but "SAH bins" keeps its capitals.
std::string in_a_sentence(std::string label) {
    if (label.size() > 1 && std::islower(static_cast<unsigned char>(label[1])))
        label[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(label[0])));
    return label;
}

const ReadySide& ready_side(const Picture& picture, unsigned side) {
    return side == 1 && picture.job.ready->other ? *picture.job.ready->other : picture.job.ready->main;
}
const PictureSide& picture_side(const Picture& picture, unsigned side) {
    return side == 1 && picture.other ? *picture.other : picture.main;
}

}  // namespace

Differences differing_settings(const Picture& picture) {
    Differences out;
    if (!picture.other) return out;
    const Settings &a = picture.main.settings, &b = picture.other->settings;
    const ReadySide &on_a = ready_side(picture, 0), &on_b = ready_side(picture, 1);
    const auto add = [&](const std::string& label, const std::string& of_a, const std::string& of_b) {
        if (of_a == of_b) return;
        out.of[0].push_back(in_a_sentence(label) + " " + of_a);
        out.of[1].push_back(in_a_sentence(label) + " " + of_b);
    };
    if (a.accel == b.accel && on_a.accel->plugin) {
        const rt_plugin& plugin = *on_a.accel->plugin;
        for (size_t i = 0; i < std::min(a.accel_params.size(), b.accel_params.size()) && i < plugin.param_count; ++i)
            add(plugin.params[i].label, exact_text(a.accel_params[i]), exact_text(b.accel_params[i]));
    }
    for (const Setting& row : settings_table()) add(row.label, row.get(a), row.get(b));
    if (on_a.devices_text() != on_b.devices_text()) {
        out.of[0].push_back(on_a.device_name());
        out.of[1].push_back(on_b.device_name());
    }
    return out;
}

Caption caption_of(const Session& session, const Picture& picture, unsigned side) {
    Caption caption;
    caption.title = std::string(side == 0 ? "A  " : "B  ") + picture_side(picture, side).settings.accel;
    caption.details = joined(differing_settings(picture).of[side]);
    const std::vector<float> mine = session.frame_times(side).recent_kernels_ms(),
                             others = session.frame_times(1 - side).recent_kernels_ms();
    if (const double ms = static_cast<double>(percentile(mine, 0.5)); ms > 0) {
        char text[64];
        std::snprintf(text, sizeof text, "%s of kernels, %.1f Mrays/s", time_text(ms).c_str(), mrays_per_second(session, side));
        caption.speed = text;
    }
    const Convergence& convergence = picture_side(picture, side).convergence;
    if (picture.job.equal_time && !convergence.points().empty()) {
        const Convergence::Point& last = convergence.points().back();
        char text[96];
        std::snprintf(text, sizeof text, "%.3g %% of error, %.4g samples in %s", 100 * last.error, last.samples,
                      time_text(1000 * last.seconds).c_str());
        caption.noise = text;
        if (std::isfinite(last.rmse)) {
            std::snprintf(text, sizeof text, ", RMSE %.4g", last.rmse);
            caption.noise += text;
        }
    }
    caption.verdict = speed_verdict(mine, others);
    caption.faster = !caption.verdict.empty() && caption.verdict != kAboutTheSame;
    return caption;
}

std::vector<HudText> caption_lines(const Caption& caption) {
    std::vector<HudText> lines = {{caption.title, colors::kText, true}};
    if (!caption.speed.empty()) lines.push_back({caption.speed, colors::kText, false, true});
    if (!caption.verdict.empty())
        lines.push_back({caption.verdict, caption.faster ? colors::kGreen : colors::kDim, caption.faster, true});
    if (!caption.noise.empty()) lines.push_back({caption.noise, colors::kText, false, true});
    if (!caption.details.empty()) lines.push_back({caption.details, colors::kDim});
    return lines;
}

std::string difference_text(const PictureDifference& difference) {
    if (difference.image.pixels.empty()) return "the pictures are of different sizes";
    if (difference.largest <= 0) return "no pixel differs";
    char text[160];
    std::snprintf(text, sizeof text,
                  "mean %.3g, largest %.0f of 255; %.3g %% of pixels differ by more than 1; shown 8 times as bright",
                  difference.mean, difference.largest, difference.share * 100);
    return text;
}

std::string speed_verdict(const std::vector<float>& mine, const std::vector<float>& others) {
    constexpr size_t kFewest = 5;
    if (std::min(mine.size(), others.size()) < kFewest) return {};
    // The 90th percentile of the faster side must be below the 10th percentile of the slower side. A single frame that another
    // program delayed then changes nothing.
    const auto beats = [](const std::vector<float>& a, const std::vector<float>& b) {
        return percentile(a, 0.9) < percentile(b, 0.1);
    };
    if (beats(others, mine)) return {};
    const auto shown = [](const std::vector<float>& ms) { return static_cast<double>(percentile(ms, 0.5)); };  // as in `speed`
    const double ratio = shown(others) / std::max(shown(mine), 1e-9);
    if (!beats(mine, others) || ratio < 1.005) return kAboutTheSame;
    char text[64];
    std::snprintf(text, sizeof text, ratio < 10 ? "%.2f\u00d7 faster" : "%.0f\u00d7 faster", ratio);
    return text;
}

}  // namespace clarity::ui
