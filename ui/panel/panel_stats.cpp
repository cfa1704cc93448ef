// The Stats tab: frames, rays, structure, times; for both sides of a comparison.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ui/panel/panel.hpp"
#include "ui/session/session_output.hpp"
#include "ui/widgets/plots.hpp"
#include "ui/widgets/theme.hpp"
#include "ui/widgets/widgets.hpp"

namespace clarity::ui {
namespace {

const ImVec4& side_color(unsigned side) {
    return side == 0 ? colors::kAccent : colors::kAmber;
}

// The text of a value for each side: "81.2 ms", or "81.2 ms | 40.1 ms" in a comparison.
struct Sides {
    std::string text;
    void add(const std::string& value) { text += (text.empty() ? "" : "   |   ") + value; }
};

std::vector<const PictureSide*> picture_sides(const std::shared_ptr<const Picture>& picture) {
    std::vector<const PictureSide*> sides;
    if (picture) sides.push_back(&picture->main);
    if (picture && picture->other) sides.push_back(&*picture->other);
    return sides;
}

void graph_legend(const std::vector<FrameSeries>& series) {
    if (series.size() < 2) return;
    for (unsigned i = 0; i < series.size(); ++i) {
        if (i > 0) ImGui::SameLine(0, 14 * ui_scale());
        ImGui::PushStyleColor(ImGuiCol_Text, side_color(i));
        ImGui::TextUnformatted(("\u25a0 " + series[i].name).c_str());
        ImGui::PopStyleColor();
    }
}

void frame_rows(Session& session) {
    const auto picture = session.picture();
    const auto sides = picture_sides(picture);
    std::vector<FrameSeries> series;
    Sides rate, median, late, latest, kernels;
    for (unsigned i = 0; i < sides.size(); ++i) {
        const FrameTimes both = session.frame_times(i);
        const std::vector<float>& times = both.frames_ms();
        char fps[32];
        std::snprintf(fps, sizeof fps, "%.1f", frames_per_second(session, i));
        rate.add(fps);
        median.add(time_text(static_cast<double>(percentile(times, 0.5))));
        kernels.add(time_text(static_cast<double>(percentile(both.recent_kernels_ms(), 0.5))));
        late.add(time_text(static_cast<double>(percentile(times, 0.95))));
        latest.add(time_text(static_cast<double>(percentile(times, 0.99))));
        series.push_back({std::string(1, "AB"[i]) + " " + sides[i]->settings.accel, times, ImGui::GetColorU32(side_color(i))});
    }
    graph_legend(series);
    const float target = session.desired.moving_fps > 0 ? 1000 / session.desired.moving_fps : 0;
    draw_frame_graph(series, target, 110 * ui_scale());
    tooltip("milliseconds of the last frames, tracing and reading back; dashed line: the time that `While moving` asks for");
    if (sides.empty()) return;
    row_text("Frames/s", rate.text, "mean of the last ten");
    row_text("p50", median.text, "the median: half of the frames were faster");
    row_text("p95", late.text, "19 frames of 20 were faster");
    row_text("p99", latest.text, "99 frames of 100 were faster");
    row_text("Kernels", kernels.text, "kernels and copies of a frame by the device's clock: median of the last 30 frames");
    row_label("Keep tracing", "trace the same picture again and again, to measure");
    ImGui::Checkbox("##continuous", &session.desired.continuous);
}

// How the estimated error falls, with samples and with seconds.
void convergence_rows(const std::vector<const PictureSide*>& sides) {
    std::vector<LogSeries> over_samples, over_seconds;
    Sides error, rmse, slope, samples;
    bool compared = false;
    for (unsigned i = 0; i < sides.size(); ++i) {
        const Convergence& side = sides[i]->convergence;
        LogSeries of_samples{{}, ImGui::GetColorU32(side_color(i))}, of_seconds = of_samples;
        for (const Convergence::Point& point : side.points()) {
            of_samples.points.emplace_back(point.samples, point.error);
            if (point.seconds > 0) of_seconds.points.emplace_back(point.seconds, point.error);
        }
        over_samples.push_back(of_samples);
        over_seconds.push_back(of_seconds);
        char text[32] = "\u2013";
        if (!side.points().empty()) std::snprintf(text, sizeof text, "%.3g %%", 100 * side.points().back().error);
        error.add(text);
        const double known = side.points().empty() ? std::nan("") : side.points().back().rmse;
        std::snprintf(text, sizeof text, std::isfinite(known) ? "%.4g" : "\u2013", known);
        rmse.add(text);
        compared |= std::isfinite(known);
        std::snprintf(text, sizeof text, std::isfinite(side.slope()) ? "%.2f" : "\u2013", side.slope());
        slope.add(text);
        samples.add(side.points().empty() ? "\u2013" : number_text(std::round(side.points().back().samples * 10) / 10));
    }
    draw_log_plot("error by samples", over_samples, -0.5, "samples", 120 * ui_scale());
    tooltip("estimated error of the picture, by its mean light; dashed line: as errors of independent samples fall");
    draw_log_plot("error by seconds", over_seconds, -0.5, "seconds", 120 * ui_scale());
    tooltip("the same, by the seconds that its samples took");
    row_text("Estimated error", error.text,
             "the root of the mean squared standard error of the pixels, by their mean light: that of independent samples");
    if (compared) row_text("RMSE", rmse.text, "the root of the mean squared difference to the picture of --reference");
    row_text("Samples", samples.text, "a pixel, when the error was estimated; the mean, where pixels rest (`Adaptive`)");
    row_text("Slope", slope.text, "the power of the samples by which the error falls; of independent samples -0.5");
}

void kernel_bars(const PictureSide& side, unsigned which) {
    const std::vector<KernelTime>& kernels = side.stats.kernels;
    const double sum = side.kernels_ms();
    double longest = 0;
    for (const KernelTime& kernel : kernels) longest = std::max(longest, kernel.ms);
    for (const KernelTime& kernel : kernels) {
        row_label(kernel.name.c_str(), "by the device's clock");
        const ImVec2 from = ImGui::GetCursorScreenPos();
        const float room = ImGui::GetContentRegionAvail().x, height = ImGui::GetFrameHeight();
        const float share = longest > 0 ? static_cast<float>(kernel.ms / longest) : 0;
        ImVec4 color = side_color(which);
        color.w = 0.4f;
        ImDrawList& list = *ImGui::GetWindowDrawList();
        list.AddRectFilled({from.x, from.y + 3 * ui_scale()},
                           {from.x + std::max(2.0f, room * share), from.y + height - 3 * ui_scale()}, ImGui::GetColorU32(color),
                           3 * ui_scale());
        char text[64];
        std::snprintf(text, sizeof text, "%s   %.0f %%", time_text(kernel.ms).c_str(), sum > 0 ? 100 * kernel.ms / sum : 0);
        list.AddText({from.x + 8 * ui_scale(), from.y + (height - ImGui::GetTextLineHeight()) / 2},
                     ImGui::GetColorU32(colors::kText), text);
        ImGui::Dummy({room, height});
    }
}

// Draws each device's share of the picture, if several take part.
void share_rows(const PictureSide& side) {
    for (const DeviceShare& share : side.stats.devices) {
        char text[96];
        std::snprintf(text, sizeof text, "%.1f %%   %s", 100 * share.share, time_text(share.device_ms).c_str());
        row_text(share.id.c_str(), text, share.name + "\nits share of the rows, and how long it traced them by its clock");
    }
}

void kernel_rows(const std::vector<const PictureSide*>& sides) {
    for (unsigned i = 0; i < sides.size(); ++i) {
        if (sides.size() > 1) wrapped_text(std::string(1, "AB"[i]) + "  " + sides[i]->settings.accel, side_color(i));
        kernel_bars(*sides[i], i);
        row_text("Sum", time_text(sides[i]->kernels_ms()), "sum of the times above");
        share_rows(*sides[i]);
    }
}

void ray_rows(const Session& session, const std::vector<const PictureSide*>& sides) {
    Sides rate, primary, shadow, secondary, dropped, overflowed;
    bool lost = false, full = false;
    for (unsigned i = 0; i < sides.size(); ++i) {
        const FrameStats& stats = sides[i]->stats;
        char text[48];
        std::snprintf(text, sizeof text, "%.1f Mrays/s", mrays_per_second(session, i));
        rate.add(text);
        primary.add(count_text(static_cast<double>(stats.primary)));
        shadow.add(count_text(static_cast<double>(stats.shadow)));
        secondary.add(count_text(static_cast<double>(stats.secondary)));
        dropped.add(count_text(static_cast<double>(stats.dropped)));
        overflowed.add(count_text(static_cast<double>(stats.overflowed)));
        lost |= stats.dropped > 0;
        full |= stats.overflowed > 0;
    }
    row_text("Rate", rate.text, "rays of all kinds, divided by the time of the kernels");
    row_text("Primary", primary.text);
    row_text("Shadow", shadow.text);
    row_text("Secondary", secondary.text, "mirrored and refracted");
    row_text("Dropped", dropped.text, "found no slot in their pixel's arrays: raise `Ray slots`",
             lost ? colors::kAmber : colors::kText);
    if (full) row_text("Stacks full", overflowed.text, "rays whose traversal stack was full", colors::kAmber);
}

// What was done to the tree of a mesh for this pose, and what its rays cost in the last ones.
void tree_row(const TreeUpdate& tree, float most) {
    const std::string name = tree.mesh == RT_NONE ? "World"
                             : tree.name.empty()  ? "Mesh " + std::to_string(tree.mesh)
                                                  : tree.name;
    const std::vector<float> costs(tree.cost_ratios.begin(), tree.cost_ratios.end());
    char now[48];
    std::snprintf(now, sizeof now, "%s  %.2f", tree.what.c_str(), static_cast<double>(costs.back()));
    ImGui::PushID(static_cast<int>(tree.mesh));
    row_label(name.c_str(), "a tree of " + count_text(static_cast<double>(tree.primitives)) +
                                (tree.mesh == RT_NONE ? " instances and triangles" : " triangles") +
                                "; what was done to it for this pose, and the expected cost of its rays (SAH) in the last "
                                "poses, against that after its build");
    ImGui::SetNextItemWidth(-FLT_MIN);
    ImGui::PlotLines("##tree", costs.data(), static_cast<int>(costs.size()), 0, now, 0, most, {0, 20 * ui_scale()});
    ImGui::PopID();
}

// How the structure came to the pose that is shown, and what rays cost in the last poses.
void pose_rows(const PoseUpdate& update) {
    if (!update.followed) return;
    row_text("Pose", (update.refitted ? "refitted   " : "built anew   ") + time_text(update.ms),
             update.why + (update.building ? "; a new tree is built beside" : ""));
    const std::vector<float> costs(update.cost_ratios.begin(), update.cost_ratios.end());
    if (costs.size() < 2) return;
    char now[32];
    std::snprintf(now, sizeof now, "%.2f", static_cast<double>(costs.back()));
    row_label("Cost of rays", "expected (SAH) in the last poses, against that after the last build");
    ImGui::SetNextItemWidth(-FLT_MIN);
    const float most = std::max(1.5f, *std::max_element(costs.begin(), costs.end()));
    ImGui::PlotLines("##costs", costs.data(), static_cast<int>(costs.size()), 0, now, 0, most, {0, 42 * ui_scale()});
    for (const TreeUpdate& tree : update.trees) tree_row(tree, most);
}

void structure_rows(const ReadySide& side, const ImportedScene& loaded) {
    const AccelData& accel = *side.accel;
    row_text("Structure", accel.plugin->name);
    const auto triangles = static_cast<double>(std::max<uint64_t>(1, accel.leaf_count));
    char rate[64];
    std::snprintf(rate, sizeof rate, "%s   %.2f M/s", time_text(accel.build_ms).c_str(),
                  accel.build_ms > 0 ? triangles / accel.build_ms * 1e-3 : 0);
    row_text("Build", rate, "the plugin's builder alone, and how many primitives a second");
    row_text("Packing", time_text(accel.pack_ms), "primitives into leaf order");
    pose_rows(side.pose_update);
    row_text("Memory", bytes_text(static_cast<double>(accel.bytes)), "nodes and leaves, on the device");
    row_text("Per primitive", number_text(std::round(static_cast<double>(accel.bytes) / triangles * 10) / 10) + " bytes",
             count_text(triangles) + " " + noun(accel.leaf_count, "primitive") + " in leaves; " +
                 count_text(static_cast<double>(loaded.placed_triangles)) + " " + noun(loaded.placed_triangles, "triangle") +
                 " in the world");
    for (const auto& [label, value] : accel.stats) row_text(label.c_str(), number_text(value), "as the plugin reports it");
}

void memory_rows(const ReadySide& side) {
    const AccelData& accel = *side.accel;
    const uint64_t all = side.device_bytes;
    uint64_t slots = 0;
    for (size_t i = 0; i < accel.slots.size(); ++i) {
        if (accel.layout->accel->slots[i].flags & RT_SLOT_HOST_ONLY) continue;  // not on the device
        const uint64_t bytes = accel.slots[i].memory.bytes();
        slots += bytes;
        row_text(("Nodes " + std::to_string(i)).c_str(), bytes_text(static_cast<double>(bytes)), "a buffer of the structure");
    }
    row_text("Leaves", bytes_text(static_cast<double>(accel.leaves.bytes())));
    const uint64_t known = slots + accel.leaves.bytes();
    row_text("Attributes", bytes_text(static_cast<double>(all > known ? all - known : 0)),
             "normals, texture coordinates, textures, materials, instances");
    row_text("Scene in all", bytes_text(static_cast<double>(all)));
}

void preparation_rows(const ImportedScene& loaded, const ReadySide& side) {
    row_text("Import", time_text(loaded.import_ms));
    row_text("Upload", side.upload_ms > 0 ? time_text(side.upload_ms) : "shared with the last");
    const std::string cached = side.compile_cached ? " (cached)" : "";
    row_text("Compile", side.compile_ms > 0 ? time_text(side.compile_ms) + cached : "shared with the last");
}

void device_rows(const ReadySide& side) {
    for (const ReadySide::Part& part : side.parts) {
        const DeviceInfo& device = part.device;
        row_text("Name", device.name);
        row_text("Platform", device.platform);
        row_text("Driver", device.driver);
        row_text("Units", std::to_string(device.compute_units) + " at " + std::to_string(device.clock_mhz) + " MHz");
        row_text("Memory", bytes_text(static_cast<double>(device.global_bytes)));
        row_text("Lanes", std::to_string(part.lanes));
    }
}

void side_sections(const Ready& ready, const ReadySide& side, const std::string& prefix) {
    if (folding_section((prefix + "STRUCTURE").c_str())) structure_rows(side, *ready.loaded);
    if (folding_section((prefix + "MEMORY ON THE DEVICE").c_str())) memory_rows(side);
    if (folding_section((prefix + "PREPARATION").c_str())) preparation_rows(*ready.loaded, side);
    if (folding_section((prefix + "DEVICE").c_str())) device_rows(side);
}

}  // namespace

void draw_statistics_tab(Session& session) {
    const auto picture = session.picture();
    const auto sides = picture_sides(picture);
    section("FRAMES");
    frame_rows(session);
    const bool converges =
        std::any_of(sides.begin(), sides.end(), [](const PictureSide* side) { return !side->convergence.points().empty(); });
    if (converges && folding_section("CONVERGENCE")) convergence_rows(sides);
    if (!sides.empty() && folding_section("TIME BY KERNEL")) kernel_rows(sides);
    if (!sides.empty() && folding_section("RAYS OF THE LAST SAMPLE")) ray_rows(session, sides);
    const auto ready = session.ready();
    if (!ready) return;
    side_sections(*ready, ready->main, ready->other ? "A: " : "");
    if (ready->other) side_sections(*ready, *ready->other, "B: ");
}

}  // namespace clarity::ui
