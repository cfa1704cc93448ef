// The tab of numbers: frames, rays, structure, times.
#include <imgui.h>

#include <algorithm>
#include <cstdio>

#include "ui/panel.hpp"
#include "ui/theme.hpp"
#include "ui/widgets.hpp"

namespace clarity {
namespace {

std::string ms_text(double ms) {
    char text[48];
    std::snprintf(text, sizeof text, ms < 10 ? "%.2f ms" : "%.1f ms", ms);
    return text;
}

float percentile(std::vector<float> values, double share) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

void frame_rows(Session& session) {
    const std::vector<float> times = session.frame_times();
    const float longest = times.empty() ? 1.0f : *std::max_element(times.begin(), times.end());
    ImGui::PlotLines("##times", times.data(), static_cast<int>(times.size()), 0, nullptr, 0, longest * 1.1f,
                     {ImGui::GetContentRegionAvail().x, 64 * ui_scale()});
    tooltip("milliseconds of the last frames, tracing and reading back");
    char fps[32];
    std::snprintf(fps, sizeof fps, "%.1f", session.frames_per_second());
    row_text("Frames/s", fps, "mean of the last ten");
    row_text("Median", ms_text(percentile(times, 0.5)));
    row_text("95 %", ms_text(percentile(times, 0.95)), "19 frames of 20 were faster");
    if (const auto picture = session.picture())
        row_text("Kernels", ms_text(picture->main.stats.device_ms), "of the last sample, by the device's clock");
    row_label("Keep tracing", "trace the same picture again and again, to measure");
    ImGui::Checkbox("##continuous", &session.wish.continuous);
}

void ray_rows(Session& session) {
    const auto picture = session.picture();
    if (!picture) return;
    const FrameStats& stats = picture->main.stats;
    char rate[48];
    std::snprintf(rate, sizeof rate, "%.1f Mrays/s", session.mrays_per_second());
    row_text("Rate", rate, "rays of all kinds by the time of the kernels");
    row_text("Primary", count_text(static_cast<double>(stats.primary)));
    row_text("Shadow", count_text(static_cast<double>(stats.shadow)));
    row_text("Secondary", count_text(static_cast<double>(stats.secondary)), "mirrored and refracted");
    if (stats.dropped > 0) ImGui::PushStyleColor(ImGuiCol_Text, colors::kAmber);
    row_text("Dropped", count_text(static_cast<double>(stats.dropped)),
             "found no slot in their pixel's arrays: raise `Ray slots`");
    if (stats.dropped > 0) ImGui::PopStyleColor();
    if (stats.overflowed > 0) row_text("Stacks full", count_text(static_cast<double>(stats.overflowed)));
}

}  // namespace

void draw_statistics_tab(Session& session) {
    section("FRAMES");
    frame_rows(session);
    section("RAYS OF THE LAST SAMPLE");
    ray_rows(session);
    const auto ready = session.ready();
    if (!ready) return;
    const Prepared& prepared = *ready->main.prepared;
    section("ACCELERATION STRUCTURE");
    row_text("Structure", prepared.accel->plugin->name);
    row_text("Build", ms_text(prepared.accel->build_ms), "the plugin's builder alone");
    row_text("Packing", ms_text(prepared.accel->pack_ms), "primitives into leaf order");
    row_text("Memory", bytes_text(static_cast<double>(prepared.accel->bytes)), "nodes and leaves, on the device");
    for (const auto& [label, value] : prepared.accel->stats)
        row_text(label.c_str(), number_text(value), "as the plugin reports it");
    section("PREPARATION");
    row_text("Import", ms_text(ready->loaded->import_ms));
    row_text("Upload", prepared.upload_ms > 0 ? ms_text(prepared.upload_ms) : "shared with the last");
    const std::string cached = prepared.compile_cached ? " (cached)" : "";
    row_text("Compile", prepared.compile_ms > 0 ? ms_text(prepared.compile_ms) + cached : "shared with the last");
    section("DEVICE");
    const DeviceInfo& device = ready->main.device->info();
    row_text("Name", device.name);
    row_text("Platform", device.platform);
    row_text("Driver", device.driver);
    row_text("Units", std::to_string(device.compute_units) + " at " + std::to_string(device.clock_mhz) + " MHz");
    row_text("Memory", bytes_text(static_cast<double>(device.global_bytes)));
    row_text("Lanes", std::to_string(prepared.settings.lanes));
}

}  // namespace clarity
