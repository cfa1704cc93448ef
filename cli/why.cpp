// clarity why: says why a pixel of the tracer `path` is noisy.
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "cli/render/frame_scene.hpp"
#include "cli/render/render_progress.hpp"
#include "picture/film_noise.hpp"
#include "stand/multi_preparer.hpp"
#include "tools/why/noise.hpp"
#include "view/view.hpp"

namespace clarity {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSamples = 1024;  // if neither --samples nor --spp says
constexpr int kMostSamples = 65536;
constexpr size_t kShownShares = 16;  // of a kind

struct Pixel {
    unsigned x = 0, y = 0;
};

Pixel pixel_of(const std::string& text, const Settings& settings) {
    const std::vector<unsigned> numbers = read_numbers<unsigned>(text);
    if (numbers.size() != 2)
        throw Error(Exit::usage, "--pixel " + text + ": expected x,y: a column and a row, counted from 0 at the top left");
    if (numbers[0] >= unsigned(settings.width) || numbers[1] >= unsigned(settings.height))
        throw Error(Exit::usage, "--pixel " + text + ": the picture has " + std::to_string(settings.width) + "x" +
                                     std::to_string(settings.height) + " pixels, counted from 0; --size changes that");
    return {numbers[0], numbers[1]};
}

// The samples are those of the first device alone: others of its kind would give the same.
Replay replay_of(const PluginRegistry& plugins, FrameScene& scene, TraceWords& words, const Pixel& pixel, SamplerPoints* points,
                 Progress& progress) {
    Settings& settings = words.settings;
    const Devices devices = open_devices({choose_device(words.device)});
    MultiPreparer preparer(plugins, devices);
    settings.optics = optics_of(*scene.scene(), scene.view(), settings);
    const auto prepared = preparer.prepare(scene.scene(), settings, progress);
    const auto blur = scene.blur(prepared, preparer);
    PathReplayer replayer(devices.front());
    Replay replay;
    progress.stage("tracing samples");
    const auto samples = static_cast<unsigned>(settings.spp);
    const auto trace = [&](const MultiPrepared& of_samples, const View& view, unsigned count, Progress& part) {
        replayer.trace(*of_samples.first(), settings, view, pixel.x, pixel.y, count, part, replay);
    };
    if (!blur) trace(*prepared, scene.view(), samples, progress);
    for (unsigned s = 0; blur && s < samples; ++s) {
        PartOf part(progress, double(s) / samples, 1.0 / samples);
        const MotionBlur::Sample& sample = blur->at(s, scene.view(), part);
        trace(*sample.prepared, scene.view(sample), 1, part);
    }
    if (points)
        *points = replayer.points(*prepared->first(), settings, scene.view(), pixel.x, pixel.y, samples,
                                  unsigned(settings.depth), progress);
    return replay;
}

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json();
}

Json shares_json(const std::vector<NoiseShare>& shares) {
    Json list = Json::array();
    for (const NoiseShare& share : shares)
        list.push_back({{"name", share.name}, {"of_variance", share.of_variance}, {"of_light", share.of_light}});
    return list;
}

// may_rest: the setting `adaptive` is on. In the picture the pixel has these samples, but perhaps not all of them.
void print_json(const NoiseReport& report, const Pixel& pixel, bool may_rest) {
    Json json = {{"pixel", {pixel.x, pixel.y}}, {"samples", report.samples}, {"not_finite", report.not_finite}};
    if (may_rest) json["picture_may_have_fewer"] = true;
    json["mean"] = Json::array();
    for (const float channel : report.mean) json["mean"].push_back(number(channel));
    json["luminance"] = report.luminance;
    json["variance"] = report.variance;
    json["error"] = report.error();
    json["cause"] = name_of(report.cause);
    json["cause_share"] = report.cause_share;
    json["sentence"] = report.sentence;
    json["by_bounce"] = shares_json(report.by_bounce);
    json["by_lobe"] = shares_json(report.by_lobe);
    json["by_strategy"] = shares_json(report.by_strategy);
    json["by_light"] = shares_json(report.by_light);
    json["histogram"] = Json::array();
    for (const NoiseBin& bin : report.histogram)
        json["histogram"].push_back(
            {{"from", bin.from}, {"to", bin.to}, {"samples", bin.samples}, {"of_variance", bin.of_variance}});
    json["brightest"] = report.brightest;
    std::printf("%s\n", json.dump(1, ' ', false, Json::error_handler_t::replace).c_str());
}

std::string bar(double share, int width) {
    const int length = static_cast<int>(std::lround(std::fmin(std::fmax(share, 0), 1) * width));
    return std::string(size_t(length), '#');
}

void print_shares(const char* title, const std::vector<NoiseShare>& shares) {
    std::printf("\n%-24s %9s %9s\n", title, "variance", "light");
    NoiseShare rest;
    for (size_t i = 0; i < shares.size(); ++i) {
        NoiseShare share = shares[i];
        if (i >= kShownShares) {  // JSON has all
            rest.of_variance += share.of_variance, rest.of_light += share.of_light;
            if (i + 1 < shares.size()) continue;
            share = rest;
            share.name = std::to_string(shares.size() - kShownShares) + " more";
        }
        const double percent = std::fabs(share.of_variance) < 5e-4 ? 0 : 100 * share.of_variance;  // no "-0.0"
        print_text("  %-22s %7.1f %% %7.1f %%  %s\n", share.name.c_str(), percent, 100 * share.of_light,
                   bar(share.of_variance, 30).c_str());
    }
}

void print_report(const Replay& replay, const NoiseReport& report, const NoiseNames& names, const Pixel& pixel, bool may_rest) {
    print_text("%s.\n\n", report.sentence.c_str());
    std::printf("pixel %u,%u, %u samples\n", pixel.x, pixel.y, report.samples);
    if (may_rest)
        std::printf(
            "  With --adaptive it rests in the picture once its error is small, so the picture may have fewer of\n"
            "  these samples: --aov samples shows how many. --samples N explains the first N\n");
    std::printf("  mean                   %.6g %.6g %.6g\n", double(report.mean[0]), double(report.mean[1]),
                double(report.mean[2]));
    std::printf("  luminance              %.6g, standard error %.3g\n", report.luminance, report.error());
    std::printf("  deviation of a sample  %.6g\n", std::sqrt(report.variance));
    std::printf("\n%-24s %9s %9s\n", "luminance of samples", "samples", "variance");
    for (size_t i = 0; i < report.histogram.size(); ++i) {
        const NoiseBin& bin = report.histogram[i];
        char range[64] = "black";
        if (i > 0) std::snprintf(range, sizeof range, "%.3g to %.3g", bin.from, bin.to);
        std::printf("  %-22s %9u %7.1f %%  %s\n", range, bin.samples, 100 * bin.of_variance,
                    bar(double(bin.samples) / report.samples, 30).c_str());
    }
    print_shares("by events", report.by_bounce);
    print_shares("by first lobe", report.by_lobe);
    print_shares("by strategy", report.by_strategy);
    print_shares("by light", report.by_light);
    std::printf("\n%-24s %9s\n", "brightest samples", "luminance");
    for (const unsigned s : report.brightest) {
        const ReplayedSample& sample = replay.samples[s];
        const rt_path_record* const most = brightest_record(replay, sample);
        const std::string what = most ? light_title(names, most->light_number) + ", " + strategy_name(most->how) + ", by " +
                                            std::to_string(most->bounce) + (most->bounce == 1 ? " event" : " events")
                                      : "no light";
        print_text("  sample %-15u %9.4g  %s\n", s, luminance_of(sample.light.data()), what.c_str());
    }
}

}  // namespace

int run_why(const PluginRegistry& plugins, const WhyCommand& command) {
    for (const std::string& file : {command.csv_file, command.points_file})
        if (!file.empty()) check_writable(file);
    RenderOptions options;
    options.scene = command.scene;
    options.trace = command.trace;
    options.pose = command.pose;
    options.fps = command.fps;
    check_pose(options.pose);
    TraceWords words = read_trace_options(plugins, options.trace);
    Settings& settings = words.settings;
    if (settings.tracer == "auto") settings.tracer = "path";
    if (settings.tracer != "path")
        throw Error(Exit::usage,
                    "--tracer " + settings.tracer + ": only pictures of `path` have noise to explain; leave it out");
    if (settings.aov != "color")
        throw Error(Exit::usage, "--aov " + settings.aov + ": `clarity why` is about colours; leave it out");
    if (command.samples > 0) settings.spp = command.samples;
    if (settings.spp == 1) settings.spp = kSamples;
    if (settings.spp > kMostSamples)
        throw Error(Exit::usage, "--samples " + std::to_string(settings.spp) + ": the paths of " +
                                     std::to_string(kMostSamples) + " samples are kept at most; fewer show the same cause");
    const Pixel pixel = pixel_of(command.pixel, settings);
    check_scene(plugins, command.scene);
    ProgressBar progress(command.quiet);
    const CancelOnSignal cancel(progress);
    FrameScene scene(plugins, options, words, progress);
    const import::ImportOptions with_pictures = import_options(options.scene, words);
    scene.take(std::make_shared<const Scene>(import::import_scene(plugins, options.scene.files, with_pictures, progress)));
    scene.place({});
    SamplerPoints points;
    const Replay replay = replay_of(plugins, scene, words, pixel, command.points_file.empty() ? nullptr : &points, progress);
    progress.clear();
    const NoiseNames names = noise_names(*scene.scene(), scene.view(), settings);
    const NoiseReport report = noise_report(replay, names);
    if (!command.csv_file.empty())
        write_text_file(command.csv_file, paths_csv(replay, report.brightest, names, *scene.scene()));
    if (!command.points_file.empty()) write_text_file(command.points_file, points_csv(points));
    const bool may_rest = adaptive_bound(settings) > 0;
    if (command.json)
        print_json(report, pixel, may_rest);
    else
        print_report(replay, report, names, pixel, may_rest);
    return static_cast<int>(Exit::done);
}

}  // namespace clarity
