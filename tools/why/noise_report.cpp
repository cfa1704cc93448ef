#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>

#include "scene/light_kinds.hpp"
#include "tools/why/noise.hpp"

namespace clarity {
namespace {

constexpr size_t kBrightest = 10;
// Bounds of the histogram are the mean times powers of 2 from this on; what is less is in one bin.
constexpr int kLeastPower = -6, kMostPower = 24;

// Deviations below this share of the mean are rounding.
constexpr double kRounding = 1e-6;

NoiseValues values_of(const Replay& replay) {
    NoiseValues values;
    for (const ReplayedSample& sample : replay.samples) {
        double sum = 0;
        for (unsigned r = 0; r < sample.records; ++r) sum += luminance_of(replay.records[sample.first_record + r].light);
        values.luminance.push_back(sum);
        if (!std::isfinite(sum)) continue;
        ++values.finite;
        values.mean += sum;
    }
    if (values.finite > 0) values.mean /= values.finite;
    for (const double value : values.luminance) {
        values.deviation.push_back(std::isfinite(value) ? value - values.mean : 0);
        values.squares += values.deviation.back() * values.deviation.back();
    }
    // Equal samples differ by what the light of their records was rounded by.
    if (values.squares < kRounding * kRounding * values.mean * values.mean * values.finite) {
        std::fill(values.deviation.begin(), values.deviation.end(), 0.0);
        values.squares = 0;
    }
    return values;
}

// Adds up the records by a number that `key` tells of each, in the order of these numbers.
template <class Key, class Name>
std::vector<NoiseShare> shares(const Replay& replay, const NoiseValues& values, Key key, Name name) {
    std::map<long, NoiseShare> parts;
    for (size_t s = 0; s < replay.samples.size(); ++s) {
        if (!std::isfinite(values.luminance[s])) continue;
        for (unsigned r = 0; r < replay.samples[s].records; ++r) {
            const rt_path_record& record = replay.records[replay.samples[s].first_record + r];
            if (record.kind != RT_PATH_LIT) continue;
            NoiseShare& part = parts[long(key(record))];
            const double light = luminance_of(record.light);
            part.of_light += light;
            part.of_variance += light * values.deviation[s];
        }
    }
    std::vector<NoiseShare> all;
    for (auto& [number, part] : parts) {
        part.name = name(number);
        part.of_light /= std::max(values.mean * values.finite, 1e-300);
        part.of_variance = values.squares > 0 ? part.of_variance / values.squares : 0;
        all.push_back(part);
    }
    return all;
}

std::vector<NoiseBin> histogram_of(const NoiseValues& values) {
    std::vector<NoiseBin> bins(1);  // black
    if (!(values.mean > 0)) {
        bins[0].samples = values.finite;
        return bins;
    }
    bins.push_back({0, std::ldexp(values.mean, kLeastPower), 0, 0});
    for (size_t s = 0; s < values.luminance.size(); ++s) {
        const double value = values.luminance[s];
        if (!std::isfinite(value)) continue;
        size_t at = 0;
        if (value > 0) {
            const int power = std::clamp(int(std::floor(std::log2(value / values.mean))), kLeastPower - 1, kMostPower);
            at = size_t(power - kLeastPower + 2);
        }
        while (bins.size() <= at) bins.push_back({bins.back().to, 2 * bins.back().to, 0, 0});
        ++bins[at].samples;
        bins[at].of_variance += values.squares > 0 ? values.deviation[s] * values.deviation[s] / values.squares : 0;
    }
    return bins;
}

std::vector<unsigned> brightest_of(const NoiseValues& values) {
    std::vector<unsigned> order(values.luminance.size());
    std::iota(order.begin(), order.end(), 0u);
    // Samples that are no number come first: they are what a user looks for.
    const auto key = [&](unsigned s) { return std::isfinite(values.luminance[s]) ? values.luminance[s] : INFINITY; };
    std::stable_sort(order.begin(), order.end(), [&](unsigned a, unsigned b) { return key(a) > key(b); });
    order.resize(std::min(order.size(), kBrightest));
    return order;
}

}  // namespace

const char* lobe_name(rt_u32 first) {
    static const char* const names[] = {"diffuse", "glossy", "transmission"};
    return first < 3 ? names[first] : "none";
}

const char* strategy_name(rt_u32 by) {
    return by == RT_BY_NEE ? "drawn (nee)" : "found (bsdf)";
}

NoiseNames noise_names(const Scene& scene, const View& view, const Settings& settings) {
    NoiseNames names;
    names.strategy = settings.strategy;
    // Lights that are off are left out of a view; the others keep their order.
    const bool all = view.lights.size() == scene.lights.size();
    size_t next = 0;
    for (size_t i = 0; i < view.lights.size(); ++i) {
        std::string name = std::string(light_kind_of(view.lights[i]).name) + " " + std::to_string(i);
        for (size_t k = all ? i : next; k < scene.lights.size(); ++k) {
            if (!all && std::memcmp(&view.lights[i], &scene.lights[k].values, sizeof view.lights[i]) != 0) continue;
            if (!scene.lights[k].name.empty()) name = scene.lights[k].name;
            next = k + 1;
            break;
        }
        names.lights.push_back(name);
    }
    return names;
}

std::string light_title(const NoiseNames& names, int light_number) {
    if (light_number == RT_LIGHT_OF_SKY) return "the sky";
    if (light_number == RT_LIGHT_OF_SURFACES) return "glowing surfaces";
    const bool known = light_number >= 0 && size_t(light_number) < names.lights.size();
    return "lamp `" + (known ? names.lights[size_t(light_number)] : std::to_string(light_number)) + "`";
}

const rt_path_record* brightest_record(const Replay& replay, const ReplayedSample& sample) {
    const rt_path_record* most = nullptr;
    for (unsigned r = 0; r < sample.records; ++r) {
        const rt_path_record& record = replay.records[sample.first_record + r];
        if (record.kind == RT_PATH_LIT && (!most || luminance_of(record.light) > luminance_of(most->light))) most = &record;
    }
    return most;
}

double NoiseReport::error() const {
    return samples > not_finite ? std::sqrt(variance / (samples - not_finite)) : 0;
}

NoiseReport noise_report(const Replay& replay, const NoiseNames& names) {
    const NoiseValues values = values_of(replay);
    NoiseReport report;
    report.samples = static_cast<unsigned>(replay.samples.size());
    report.not_finite = report.samples - values.finite;
    report.mean = replay.mean;
    report.luminance = values.mean;
    report.variance = values.finite > 1 ? values.squares / (values.finite - 1) : 0;
    report.histogram = histogram_of(values);
    report.by_bounce =
        shares(replay, values, [](const rt_path_record& r) { return r.bounce; }, [](long n) { return std::to_string(n); });
    report.by_lobe =
        shares(replay, values, [](const rt_path_record& r) { return r.first; }, [](long n) { return lobe_name(rt_u32(n)); });
    report.by_strategy =
        shares(replay, values, [](const rt_path_record& r) { return r.how; }, [](long n) { return strategy_name(rt_u32(n)); });
    report.by_light = shares(
        replay, values, [](const rt_path_record& r) { return r.light_number; },
        [&](long n) { return light_title(names, int(n)); });
    std::stable_sort(report.by_light.begin(), report.by_light.end(),
                     [](const NoiseShare& a, const NoiseShare& b) { return a.of_variance > b.of_variance; });
    report.brightest = brightest_of(values);
    find_cause(replay, values, names, report);
    return report;
}

}  // namespace clarity
