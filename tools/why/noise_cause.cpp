// noise_cause.cpp -- names the likely cause of a pixel's noise. Each record of light has a share of the variance; a record is
// of the first cause in the table that it fits, and the cause with the largest share is named, if that is large enough.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "base/text.hpp"
#include "tools/why/noise.hpp"

namespace clarity {
namespace {

// A pixel is noisy if a sample's standard deviation is at least so many times the mean. Light that only a part of the samples
// see, in half of them or in fewer, has 1 and more.
constexpr double kNoisy = 1;
// The share from which on a cause is named.
constexpr double kNamed = 0.5;
// Light that fewer than this share of the samples find is hard to find.
constexpr double kSeldom = 0.2;
// A lobe is narrow at a direction where its density, per steradian, is this, which no diffuse surface has, and so many times
// that of what drew the direction.
constexpr double kNarrow = 1, kTimes = 4;
// Deep: light by so many events. Many: so many lights are drawn about equally often.
constexpr unsigned kDeep = 4;
constexpr double kMany = 8;

// A record of light, with what came before it on its path.
struct Lit {
    unsigned sample;
    const rt_path_record* record;
    const rt_path_record* last;  // the event before the ray that found it; null: none, or the light was drawn
    bool after_diffuse;          // an event before that one was diffuse
    double share;                // of the variance
};

std::vector<Lit> lit_of(const Replay& replay, const NoiseValues& values) {
    std::vector<Lit> all;
    for (unsigned s = 0; s < replay.samples.size(); ++s) {
        if (!std::isfinite(values.luminance[s])) continue;
        const rt_path_record* last = nullptr;
        bool diffuse = false;  // an event before `last`
        for (unsigned r = 0; r < replay.samples[s].records; ++r) {
            const rt_path_record& record = replay.records[replay.samples[s].first_record + r];
            if (record.kind == RT_PATH_SCATTERS) {
                diffuse |= last && last->how == RT_FIRST_DIFFUSE;
                last = &record;
            } else if (record.kind == RT_PATH_LIT) {
                const bool found = record.how == RT_BY_BSDF;
                all.push_back({s, &record, found ? last : nullptr, found && diffuse,
                               luminance_of(record.light) * values.deviation[s] / values.squares});
            }
        }
    }
    return all;
}

bool is_narrow(const rt_path_record& event) {
    return event.how != RT_FIRST_DIFFUSE && ((event.flags & RT_PATH_SMOOTH) || event.pdf > kNarrow);
}

// What the rules below ask of all records together.
struct Whole {
    double seldom = 0;  // share of the samples that find light behind a broad lobe
    double lights = 0;  // how many lights are drawn, if those that are drawn more seldom count less
    bool draws = true;  // whether points of lamps are drawn
};

Whole whole_of(const std::vector<Lit>& all, unsigned samples, const NoiseNames& names) {
    Whole whole;
    std::set<unsigned> finding;
    std::map<int, double> drawn;
    double draws = 0;
    for (const Lit& lit : all) {
        if (lit.last && !is_narrow(*lit.last)) finding.insert(lit.sample);
        if (lit.record->how == RT_BY_NEE) ++drawn[lit.record->light_number], ++draws;
    }
    whole.seldom = samples > 0 ? double(finding.size()) / samples : 0;
    double squares = 0;
    for (const auto& [light, count] : drawn) squares += count / draws * (count / draws);
    whole.lights = squares > 0 ? 1 / squares : 0;
    whole.draws = names.strategy != "bsdf";
    return whole;
}

struct Rule {
    NoiseCause cause;
    bool (*fits)(const Lit& lit, const Whole& whole);
};

const Rule kRules[] = {
    {NoiseCause::edge, [](const Lit& lit, const Whole&) { return lit.record->bounce == 0; }},
    {NoiseCause::caustic, [](const Lit& lit, const Whole&) { return lit.last && lit.after_diffuse && is_narrow(*lit.last); }},
    {NoiseCause::lamp,
     [](const Lit& lit, const Whole& whole) {
         const bool broad = lit.last && !is_narrow(*lit.last);
         return broad && whole.seldom < kSeldom && (!whole.draws || lit.record->other_pdf == 0);
     }},
    {NoiseCause::lobe,
     [](const Lit& lit, const Whole&) {
         const rt_path_record& r = *lit.record;
         return r.how == RT_BY_NEE && r.other_pdf > kNarrow && r.other_pdf > kTimes * r.pdf;
     }},
    {NoiseCause::deep, [](const Lit& lit, const Whole&) { return lit.record->bounce >= kDeep; }},
    {NoiseCause::lights,
     [](const Lit& lit, const Whole& whole) { return lit.record->how == RT_BY_NEE && whole.lights >= kMany; }},
};

NoiseCause cause_of(const Lit& lit, const Whole& whole) {
    for (const Rule& rule : kRules)
        if (rule.fits(lit, whole)) return rule.cause;
    return NoiseCause::mixed;
}

std::string percent_text(double share) {
    char text[32];
    std::snprintf(text, sizeof text, share < 0.0995 ? "%.1f %%" : "%.0f %%", 100 * share);
    return text;
}

// The light that brings most of some records' share.
std::string main_light(const std::vector<const Lit*>& records, const NoiseNames& names) {
    std::map<int, double> by_light;
    for (const Lit* lit : records) by_light[lit->record->light_number] += lit->share;
    const auto most =
        std::max_element(by_light.begin(), by_light.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == by_light.end() ? "light" : light_title(names, most->first);
}

// Behind "93 % of the variance comes from 4 of 1024 samples".
std::string words_of(NoiseCause cause, const std::vector<const Lit*>& records, const Whole& whole, const NoiseNames& names) {
    const std::string light = main_light(records, names);
    switch (cause) {
        case NoiseCause::edge:
            return " in which the camera itself sees " + light +
                   ": its edge crosses the pixel; try more samples, which smooth the edge";
        case NoiseCause::caustic:
            return " which reach " + light +
                   " by a mirror or glass behind a diffuse surface: a caustic, which no strategy draws; try a larger "
                   "lamp of the same power, rougher mirrors and glass, or many more samples";
        case NoiseCause::lamp:
            return " in which scattered rays happen to find " + light + ": a small bright lamp that few rays meet; try " +
                   (whole.draws
                        ? "a lamp of the scene instead of what shines there, because no point of this can be drawn, or a "
                          "larger one"
                        : "--strategy mis, which draws points of the lamp, too");
        case NoiseCause::lobe:
            return " that draw a point of " + light +
                   " at a glossy surface: its lobe is narrow, and drawn points seldom lie in it; try --strategy mis, which "
                   "follows the lobe, too";
        case NoiseCause::lights:
            return " which draw the right one of many lights, most of all " + light +
                   ": each event asks only one lamp; try more samples, or fewer lamps that are stronger";
        case NoiseCause::deep:
            return " with light that was scattered " + std::to_string(kDeep) +
                   " or more times: deep bounces; try more samples, or brighter lamps where light may enter directly; a "
                   "smaller --depth has less noise and less light";
        default:
            return "";
    }
}

// Without one large cause: the part that is largest by bounce and by light.
std::string mixed_words(const NoiseReport& report) {
    const auto largest = [](const std::vector<NoiseShare>& shares) {
        return *std::max_element(shares.begin(), shares.end(),
                                 [](const NoiseShare& a, const NoiseShare& b) { return a.of_variance < b.of_variance; });
    };
    const NoiseShare bounce = largest(report.by_bounce), light = largest(report.by_light);
    return "No cause stands out: " + percent_text(bounce.of_variance) + " of the variance is light by " + bounce.name +
           (bounce.name == "1" ? " event, " : " events, ") + percent_text(light.of_variance) + " is that of " + light.name +
           "; try more samples: four times as many halve the error";
}

}  // namespace

const char* name_of(NoiseCause cause) {
    static const char* const names[] = {"black", "quiet",  "not_finite", "lamp", "caustic",
                                        "lobe",  "lights", "deep",       "edge", "mixed"};
    return names[static_cast<size_t>(cause)];
}

void find_cause(const Replay& replay, const NoiseValues& values, const NoiseNames& names, NoiseReport& report) {
    const std::string all = plural(report.samples, "sample");
    if (report.not_finite > 0) {
        report.cause = NoiseCause::not_finite;
        report.sentence = std::to_string(report.not_finite) + " of " + all +
                          (report.not_finite == 1 ? " is no finite number" : " are no finite numbers") +
                          ": a fault of a kernel, or of numbers in the scene; look at the paths of --csv";
        return;
    }
    if (!(values.mean > 0)) {
        report.cause = NoiseCause::black;
        report.sentence = "No light arrives by any of " + all;
        return;
    }
    const double deviation = std::sqrt(report.variance);
    if (deviation < kNoisy * values.mean) {
        report.cause = NoiseCause::quiet;
        report.sentence = "This pixel is not noisy: the standard error of its mean is " +
                          percent_text(report.error() / values.mean) + " after " + all +
                          ", and a sample deviates by less than the mean";
        return;
    }
    const std::vector<Lit> lit = lit_of(replay, values);
    const Whole whole = whole_of(lit, report.samples, names);
    std::map<NoiseCause, double> by_cause;
    for (const Lit& one : lit) by_cause[cause_of(one, whole)] += one.share;
    const auto most =
        std::max_element(by_cause.begin(), by_cause.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    report.cause = most->first;
    report.cause_share = most->second;
    if (most->second < kNamed || most->first == NoiseCause::mixed) {
        report.cause = NoiseCause::mixed;
        report.sentence = mixed_words(report);
        return;
    }
    std::vector<const Lit*> records;
    std::set<unsigned> samples;  // that raise the variance by it
    for (const Lit& one : lit)
        if (cause_of(one, whole) == report.cause && one.share > 0) records.push_back(&one), samples.insert(one.sample);
    report.sentence = percent_text(report.cause_share) + " of the variance comes from " + std::to_string(samples.size()) +
                      " of " + all + words_of(report.cause, records, whole, names);
}

}  // namespace clarity
