#include "cli/render/render_stats.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/statistics.hpp"
#include "launch/prepared.hpp"
#include "stand/multi_frame_renderer.hpp"
#include "tools/compare/picture_errors.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

using Json = nlohmann::ordered_json;

// Rounds a time to the microsecond; further digits are noise.
double rounded(double ms) {
    return double(int64_t(ms * 1000 + 0.5)) / 1000;
}

Json times_json(const std::vector<double>& values) {
    if (values.empty()) return nullptr;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return {{"median", rounded(median(values))}, {"min", rounded(*least)}, {"max", rounded(*most)}};
}

// Writes a whole number without decimals: 4, not 4.0.
Json number_json(double value) {
    const auto whole = static_cast<int64_t>(std::clamp(value, -1e15, 1e15));
    return double(whole) == value ? Json(whole) : Json(value);
}

Json accel_parameters(const AccelData& accel) {
    Json json = Json::object();
    for (rt_u32 i = 0; i < accel.plugin->param_count && i < accel.params.size(); ++i) {
        const rt_param& param = accel.plugin->params[i];
        const double value = accel.params[i];
        if (param.kind == RT_PARAM_BOOL)
            json[param.key] = value != 0;
        else if (param.kind == RT_PARAM_ENUM)
            json[param.key] = param.choices[static_cast<size_t>(value)];
        else
            json[param.key] = number_json(value);
    }
    return json;
}

Json shares_json(const std::vector<DeviceShare>& shares) {
    Json json = Json::array();
    for (const DeviceShare& share : shares)
        json.push_back({{"id", share.id},
                        {"name", share.name},
                        {"share", rounded(share.share)},
                        {"frame_ms", rounded(share.device_ms)},
                        {"frame_wall_ms", rounded(share.wall_ms)},
                        {"launches", share.launches}});
    return json;
}

}  // namespace

double median_frame_ms(const RenderStats& stats) {
    return median(stats.frame_ms);
}

double mrays_per_s(const RenderStats& stats) {
    const double ms = median_frame_ms(stats);
    return ms > 0 ? double(stats.primary + stats.shadow + stats.secondary) / ms / 1000 : 0;
}

void gather_prepare_times(RenderStats& stats, Ranks& ranks) {
    const auto begin = std::chrono::steady_clock::now();
    stats.ranks.clear();
    for (const double ms : ranks.gather(stats.prepare_ms)) stats.ranks.push_back({ms, 0, 0});
    stats.wait_to_trace_ms = ms_since(begin);
}

void gather_frame_times(RenderStats& stats, Ranks& ranks) {
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<double> device_ms = ranks.gather(median(stats.frame_ms));
    stats.wait_traced_ms = ms_since(begin);
    const std::vector<double> wall_ms = ranks.gather(median(stats.wall_ms));
    for (size_t r = 0; r < wall_ms.size(); ++r) {
        stats.ranks[r].frame_ms = device_ms[r];
        stats.ranks[r].wall_ms = wall_ms[r];
    }
    for_each_member(static_cast<RayCounts&>(stats), [&](uint64_t& count) {
        double sum = 0;
        for (const double of_rank : ranks.gather(double(count))) sum += of_rank;
        count = static_cast<uint64_t>(sum);
    });
}

namespace {

Json figure(double value) {
    return std::isfinite(value) ? Json(value) : Json();
}

Json reference_json(const ReferenceRun& run) {
    Json json = {{"file", run.file()}, {"slope", figure(run.slope())}, {"points", Json::array()}};
    for (const ReferenceRun::Point& point : run.points()) {
        const PictureErrors& e = point.errors;
        json["points"].push_back({{"samples", point.samples},
                                  {"rmse", figure(e.rmse)},
                                  {"relmse", figure(e.relmse)},
                                  {"trimmed_rmse", figure(e.trimmed_rmse)},
                                  {"mean", figure(e.mean)},
                                  {"mean_ratio", figure(e.mean_ratio)},
                                  {"flip", figure(e.flip)},
                                  {"largest", figure(e.largest)},
                                  {"not_finite", e.not_finite}});
    }
    return json;
}

}  // namespace

PictureCost cost_of(const FloatImage& values) {
    PictureCost cost;
    for (const float value : values.pixels) cost.mean += value, cost.greatest = std::max<double>(cost.greatest, value);
    if (!values.pixels.empty()) cost.mean /= double(values.pixels.size());
    return cost;
}

std::string stats_json(const RenderStats& stats) {
    const Prepared& prepared = *stats.prepared;
    const AccelData& accel = *prepared.accel;
    const Settings& used = prepared.settings;  // automatic settings are resolved here
    Json json;
    json["files"] = stats.files;
    json["device"] = devices_name(stats.devices);
    json["device_id"] = device_list_text(stats.devices);
    json["driver"] = stats.devices.front().platform + ", " + stats.devices.front().driver;
    if (!stats.shares.empty()) json["devices"] = shares_json(stats.shares);
    json["accel"] = used.accel;
    json["accel_params"] = accel_parameters(accel);
    json["tracer"] = used.tracer;
    json["depth"] = stats.settings.depth;
    json["packet"] = std::to_string(used.packet_w) + "x" + std::to_string(used.packet_h);
    json["lanes"] = used.lanes;
    json["size"] = std::to_string(stats.settings.width) + "x" + std::to_string(stats.settings.height);
    if (const Crop& crop = stats.settings.crop; crop.whole_width > 0)
        json["crop"] = {
            {"x", crop.x}, {"y", crop.y}, {"of", std::to_string(crop.whole_width) + "x" + std::to_string(crop.whole_height)}};
    json["spp"] = stats.settings.spp;
    json["samples"] = stats.samples;
    if (stats.noise) json["estimated_error"] = figure(stats.noise->error), json["mean_samples"] = stats.noise->mean_samples;
    if (const double bound = adaptive_bound(stats.settings); bound > 0) json["adaptive"] = bound;
    if (denoises(stats.settings)) json["denoised"] = true;
    json["shutter"] = stats.settings.shutter;
    json["aov"] = used.aov;
    if (stats.cost) json["aov_mean"] = stats.cost->mean, json["aov_greatest"] = stats.cost->greatest;
    json["shadows"] = stats.settings.shadows;
    json["frames_timed"] = stats.frame_ms.size();
    json["frame_ms"] = times_json(stats.frame_ms);
    json["frame_wall_ms"] = times_json(stats.wall_ms);
    if (!stats.ranks.empty()) {
        for (const RankTimes& rank : stats.ranks)
            json["ranks"].push_back({{"prepare_ms", rounded(rank.prepare_ms)},
                                     {"frame_ms", rounded(rank.frame_ms)},
                                     {"frame_wall_ms", rounded(rank.wall_ms)}});
        json["share_ms"] = rounded(stats.share_ms);
        json["prepare_ms"] = rounded(stats.prepare_ms);
        json["wait_ms"] = {{"to_trace", rounded(stats.wait_to_trace_ms)}, {"traced", rounded(stats.wait_traced_ms)}};
        json["collect_ms"] = rounded(stats.collect_ms);
    }
    json["build_ms"] = rounded(accel.build_ms);
    json["pack_ms"] = rounded(accel.pack_ms);
    json["upload_ms"] = rounded(prepared.upload_ms);
    json["compile_ms"] = rounded(prepared.compile_ms);
    json["compile_cached"] = prepared.compile_cached;
    json["import_ms"] = rounded(stats.import_ms);
    json["first_picture_ms"] = rounded(stats.first_picture_ms);
    json["rays"] = {{"primary", stats.primary}, {"shadow", stats.shadow}, {"secondary", stats.secondary}};
    json["mrays_per_s"] = rounded(mrays_per_s(stats));
    json["dropped_rays"] = stats.dropped;
    json["samples_not_finite"] = stats.not_finite;
    json["stack_overflows"] = stats.overflowed;
    json["nodes"] = uint64_t(accel.stat("nodes"));
    json["accel_bytes"] = accel.bytes;
    json["texture_bytes"] = prepared.scene->texels.size() * sizeof(uint32_t);
    json["accel_stats"] = Json::object();
    for (const auto& [label, value] : accel.stats) json["accel_stats"][label] = number_json(value);
    if (stats.reference) json["reference"] = reference_json(*stats.reference);
    json["triangles"] = prepared.scene->placed_triangle_count();
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

ReferenceRun::ReferenceRun(const std::string& file, const Settings& settings)
    : settings_(settings), file_(file), reference_(read_reference(file, settings)) {
    if (!find_aov(settings.aov).is_color())
        throw Error(Exit::usage, "--reference " + file + ": is compared with colours; leave out --aov " + settings.aov);
}

void ReferenceRun::offer(MultiFrameRenderer& frames, unsigned samples, bool finished) {
    const unsigned last = points_.empty() ? 0 : points_.back().samples;
    if (samples < 2 * last && !(finished && samples > last)) return;
    points_.push_back({samples, picture_errors(frames.read_picture(settings_), reference_)});
}

double ReferenceRun::slope() const {
    std::vector<std::pair<unsigned, double>> errors;
    for (const Point& point : points_) errors.emplace_back(point.samples, point.errors.rmse);
    return error_slope(errors);
}

}  // namespace clarity
