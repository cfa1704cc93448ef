// The rows of the Inspect tab that say why a pixel of the tracer `path` is noisy.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/files/output_file.hpp"
#include "base/text.hpp"
#include "ui/panel/panel.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

constexpr size_t kMostRows = 6;  // of a kind of shares

std::string percent(double share) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f %%", 100 * (std::fabs(share) < 5e-4 ? 0 : share));
    return text;
}

// A bar of the rest of the line, with a text on it.
void bar(double share, const std::string& text) {
    const ImVec2 at = ImGui::GetCursorScreenPos(),
                 size(ImGui::GetContentRegionAvail().x, ImGui::GetTextLineHeight() + 2 * ui_scale());
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float filled = size.x * static_cast<float>(std::clamp(share, 0.0, 1.0));
    list.AddRectFilled(at, {at.x + size.x, at.y + size.y}, ImGui::GetColorU32(ImGuiCol_FrameBg), 2 * ui_scale());
    ImVec4 color = colors::kAccent;
    color.w = 0.55f;
    if (filled > 0) list.AddRectFilled(at, {at.x + filled, at.y + size.y}, ImGui::GetColorU32(color), 2 * ui_scale());
    list.AddText({at.x + 5 * ui_scale(), at.y + ui_scale()}, ImGui::GetColorU32(colors::kText), text.c_str());
    ImGui::Dummy(size);
}

void share_rows(const char* title, const char* help, const std::vector<NoiseShare>& shares) {
    ImGui::Dummy({0, 3 * ui_scale()});
    dim_text(title);
    tooltip(help);
    std::vector<NoiseShare> shown = shares;
    std::stable_sort(shown.begin(), shown.end(),
                     [](const NoiseShare& a, const NoiseShare& b) { return a.of_variance > b.of_variance; });
    NoiseShare rest;
    for (size_t i = kMostRows; i < shown.size(); ++i)
        rest.of_variance += shown[i].of_variance, rest.of_light += shown[i].of_light;
    if (shown.size() > kMostRows) {
        rest.name = plural(shown.size() - kMostRows, "other");
        shown.resize(kMostRows);
        shown.push_back(rest);
    }
    for (const NoiseShare& share : shown) {
        row_label(share.name.c_str(), "share of the variance; it brings " + percent(share.of_light) + " of the light");
        bar(share.of_variance, percent(share.of_variance));
    }
}

// A column for each bin, as high as the logarithm of its samples.
void histogram(const NoiseReport& report) {
    std::vector<float> columns;
    for (const NoiseBin& bin : report.histogram) columns.push_back(std::log2(1 + static_cast<float>(bin.samples)));
    const float most = std::max(1.0f, *std::max_element(columns.begin(), columns.end()));
    const ImVec2 at = ImGui::GetCursorScreenPos(), size(ImGui::GetContentRegionAvail().x, 60 * ui_scale());
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(at, {at.x + size.x, at.y + size.y}, ImGui::GetColorU32(ImGuiCol_FrameBg), 2 * ui_scale());
    ImGui::InvisibleButton("##histogram", size);
    note_rect("Histogram");
    const float step = size.x / static_cast<float>(columns.size());
    const float mouse = (ImGui::GetIO().MousePos.x - at.x) / step;
    const int under =
        ImGui::IsItemHovered() ? std::clamp(static_cast<int>(mouse), 0, static_cast<int>(columns.size()) - 1) : -1;
    for (size_t i = 0; i < columns.size(); ++i) {
        const float left = at.x + step * static_cast<float>(i), height = (size.y - 4 * ui_scale()) * columns[i] / most;
        const ImVec4& color = static_cast<int>(i) == under            ? colors::kText
                              : report.histogram[i].of_variance > 0.1 ? colors::kAmber
                                                                      : colors::kAccent;
        list.AddRectFilled({left + ui_scale(), at.y + size.y - height}, {left + step - ui_scale(), at.y + size.y},
                           ImGui::GetColorU32(color));
    }
    if (under < 0) return;
    const NoiseBin& bin = report.histogram[static_cast<size_t>(under)];
    char range[64] = "black";
    if (under > 0) std::snprintf(range, sizeof range, "luminance %.3g to %.3g", bin.from, bin.to);
    tooltip(std::string(range) + ": " + plural(bin.samples, "sample") + ", " + percent(bin.of_variance) + " of the variance");
}

// "sample 404", and what brought most of its light.
void path_rows(const NoiseInspection& noise, UiState& state) {
    for (size_t i = 0; i < noise.report.brightest.size(); ++i) {
        const unsigned s = noise.report.brightest[i];
        const ReplayedSample& sample = noise.replay.samples[s];
        const rt_path_record* const most = brightest_record(noise.replay, sample);
        std::string lines;
        for (unsigned r = 0; r < sample.records; ++r) {
            const rt_path_record& record = noise.replay.records[sample.first_record + r];
            char line[200];
            if (record.kind == RT_PATH_SCATTERS)
                std::snprintf(line, sizeof line, "%u: %s%s, throughput %.3g, density %.3g\n", record.bounce,
                              lobe_name(record.how), record.flags & RT_PATH_SMOOTH ? ", smooth" : "",
                              luminance_of(record.weight), double(record.pdf));
            else if (record.kind == RT_PATH_LIT)
                std::snprintf(line, sizeof line, "%u: light %.3g, %s, weight %.3g, densities %.3g and %.3g\n", record.bounce,
                              luminance_of(record.light), strategy_name(record.how), double(record.mis), double(record.pdf),
                              double(record.other_pdf));
            else
                continue;
            lines += line;
        }
        char label[160];
        std::snprintf(
            label, sizeof label, "%9.4g  %s##path%zu", luminance_of(sample.light.data()),
            most ? (light_title(noise.names, most->light_number) + ", " + plural(most->bounce, "event")).c_str() : "no light",
            i);
        const bool chosen = state.selected_path == static_cast<int>(i);
        if (ImGui::Selectable(label, chosen)) state.selected_path = chosen ? -1 : static_cast<int>(i);
        note_rect("path " + std::to_string(i));
        if (ImGui::IsItemHovered())
            tooltip("sample " + std::to_string(s) + ", events from the camera on\n" + lines +
                    "a click marks it in the picture");
    }
}

void save_csv(Session& session, UiState& state, const NoiseInspection& noise) {
    attempt(session, [&] {
        const std::string path =
            state.pictures_folder + "/noise_" + std::to_string(noise.x) + "_" + std::to_string(noise.y) + ".csv";
        write_text_file(path, paths_csv(noise.replay, noise.report.brightest, noise.names, *noise.job.ready->scene));
        state.notify("saved " + path);
    });
}

void report_rows(Session& session, UiState& state, const NoiseInspection& noise) {
    const NoiseReport& report = noise.report;
    wrapped_text(report.sentence + ".",
                 report.cause == NoiseCause::quiet || report.cause == NoiseCause::black ? colors::kText : colors::kAmber);
    row_text("Samples",
             std::to_string(report.samples) + " of pixel " + std::to_string(noise.x) + ", " + std::to_string(noise.y),
             "as many as the picture has, 256 to 4096");
    char text[64];
    std::snprintf(text, sizeof text, "%.4g, \u00b1 %.1f %%", report.luminance,
                  report.luminance > 0 ? 100 * report.error() / report.luminance : 0);
    row_text("Luminance", text, "mean of these samples, and the standard error of independent ones");
    dim_text("Samples by luminance, from black ones on");
    tooltip("bounds double from column to column; amber columns have more than a tenth of the variance");
    histogram(report);
    share_rows("Variance by events", "of scattering between the light and the camera", report.by_bounce);
    share_rows("Variance by first lobe", "how the surface that the camera sees scatters", report.by_lobe);
    share_rows("Variance by strategy", "light that was drawn, or that rays have found", report.by_strategy);
    share_rows("Variance by light", "lamps, glowing surfaces and the sky", report.by_light);
    ImGui::Dummy({0, 3 * ui_scale()});
    dim_text("Brightest samples");
    path_rows(noise, state);
    const float half = share_of_line(2);
    if (toggle_button("Draw the paths", state.show_paths, "draw the brightest paths as lines in the scene", half))
        state.show_paths = !state.show_paths;
    ImGui::SameLine();
    if (button("Save CSV", "the brightest paths with throughput, densities and weights, into the folder of pictures", half))
        save_csv(session, state, noise);
    draw_sampler_rows(noise.points, state);
}

}  // namespace

void draw_noise_rows(Session& session, UiState& state, unsigned x, unsigned y) {
    section("NOISE");
    if (button("Why is this pixel noisy?", "traces the pixel's samples once more, with their paths", -FLT_MIN)) {
        state.selected_path = -1;
        session.explain(x, y);
    }
    const auto noise = session.inspector().latest_noise();
    if (!noise) return;
    if (!noise->failure.empty())
        wrapped_text(noise->failure, colors::kAmber);
    else
        report_rows(session, state, *noise);
}

}  // namespace clarity::ui
