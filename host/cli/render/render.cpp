// clarity render: renders a scene to picture files, without a window.
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/file_watch.hpp"
#include "base/files/frame_path.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "cli/render/frame_range.hpp"
#include "cli/render/frame_scene.hpp"
#include "cli/render/render_progress.hpp"
#include "cli/render/render_stats.hpp"
#include "device/kernel_watch.hpp"
#include "plugin/library_watch.hpp"
#include "render/multi/multi_device_film.hpp"
#include "render/multi/multi_frame_renderer.hpp"

namespace clarity {
namespace {

using Clock = std::chrono::steady_clock;

// Each repetition stores two times of 8 bytes, and there is one more pass to warm up: with this bound neither memory nor the
// pass counter comes near its limit.
constexpr unsigned kMaxRepeat = 1000000;

// Checks all options which can be checked before any work is done. Throws Error.
void check_options(const RenderOptions& options, const Settings& settings, const FrameRange& range) {
    check_output_path(frame_path(options.output, range.first));
    if (range.count() > 1 && frame_path(options.output, 1) == frame_path(options.output, 2))
        throw Error(Exit::usage, "--frames " + options.frames + " would write " + std::to_string(range.count()) +
                                     " pictures to " + options.output + ": put #### into its name, for the frame's number");
    if (writes_display(options.output) && uint64_t(settings.width) * uint64_t(settings.height) > kPngMaxPixels)
        throw Error(Exit::usage, "--size: a PNG of so many pixels is beyond its encoder; write .exr or .pfm");
    if (!options.stats_file.empty() && options.stats_file != "-") check_writable(options.stats_file);
    if (options.repeat < 1 || options.repeat > kMaxRepeat)
        throw Error(Exit::usage, "--repeat " + std::to_string(options.repeat) + ": expected a number from 1 to " +
                                     std::to_string(kMaxRepeat));
    check_pose(options.pose);
    if (options.skip_existing && options.watch)
        throw Error(Exit::usage, "--skip-existing leaves the pictures that --watch is to render again; leave one of them out");
    // The numbers of a camera can be checked without a scene, its name cannot.
    const bool named = !options.trace.camera.empty() && (options.trace.camera.find(',') == std::string::npos ||
                                                         options.trace.camera.find_first_of("0123456789+-.") != 0);
    make_view(Scene{}, 1, named ? std::string() : options.trace.camera, options.trace.light);
}

class RenderJob {
 public:
    RenderJob(const PluginRegistry& plugins, const RenderOptions& options)
        : options_(options),
          words_(read_trace_options(plugins, options.trace)),
          settings_(words_.settings),
          range_(options.frames.empty() ? FrameRange{} : parse_frame_range(options.frames)),
          plugins_(plugins),
          bar_(options.quiet),
          scene_(plugins, options, words_, bar_) {
        stats_.files = options.scene.files;
        stats_.settings = settings_;
    }

    int run() {
        check_options(options_, settings_, range_);
        check_scene(plugins_, options_.scene);
        if (!next(range_.first)) return static_cast<int>(tell_skipped(0));
        const CancelOnSignal cancel(bar_);
        take_devices(open_devices(choose_devices(words_.device)));
        for (const DeviceInfo& info : stats_.devices) log(LogLevel::debug, "device " + info.id() + " " + info.name);
        if (options_.watch) return watch();
        return static_cast<int>(round(bar_));
    }

 private:
    // Imports, builds and compiles what is not up to date, then renders all pictures.
    Exit round(Progress& progress) {
        if (!scene_.imported()) import(progress);
        const bool moving = scene_.follows_frames();
        std::optional<MultiFrameRenderer> frames;  // made when its program has been compiled, which prepare() can cancel
        long rendered = 0;
        for (auto number = next(range_.first); number; number = next(long(*number) + range_.step), ++rendered) {
            if (moving || !scene_.placed()) scene_.place(moving ? number : std::nullopt);
            if (moving || rendered == 0) prepare(progress);
            if (!frames) frames.emplace(devices_);
            const bool whole = render(*frames, *number, progress);
            if (!whole) return Exit::interrupted;
        }
        if (rendered > 0) report();
        return tell_skipped(rendered);
    }

    std::optional<int> next(long from) const {
        return next_frame(range_, from, options_.skip_existing ? options_.output : std::string());
    }

    Exit tell_skipped(long rendered) const {
        if (const long skipped = range_.count() - rendered; skipped > 0)
            log(LogLevel::info, std::to_string(skipped) + " of " + std::to_string(range_.count()) +
                                    " pictures were there already; without --skip-existing they are rendered again");
        return Exit::done;
    }

    // Renders one round after each save until a signal comes. Returns the exit code of the last round.
    int watch() {
        std::mutex mutex;
        std::condition_variable wake;
        const auto changed = [&] {
            const std::lock_guard<std::mutex> lock(mutex);
            wake.notify_all();
        };
        auto kernels = std::make_unique<KernelWatch>(plugins_.with_kernels(), changed);
        const FileWatch scenes(options_.scene.files, changed);
        LibraryWatch libraries(plugins_, changed);
        if (kernels->files().empty())
            log(LogLevel::warning,
                "--watch: kernels are not watched, because the program uses those built into it; set CLARITY_KERNEL_PATH to a "
                "folder of kernels to edit");
        for (;;) {
            const uint64_t kernels_seen = kernels->revision(), scenes_seen = scenes.revision(),
                           libraries_seen = libraries.revision();
            const auto saved = [&] {
                return kernels->revision() != kernels_seen || scenes.revision() != scenes_seen ||
                       libraries.revision() != libraries_seen;
            };
            const Exit code = guarded_round(saved);
            bar_.clear();
            if (interrupted()) return static_cast<int>(Exit::interrupted);
            if (!saved()) log(LogLevel::info, "waiting for a change of a kernel, a plugin or a scene file; Ctrl-C ends");
            {
                // A signal does not notify the condition variable, so that it must be polled.
                std::unique_lock<std::mutex> lock(mutex);
                while (!saved() && !interrupted()) wake.wait_for(lock, std::chrono::milliseconds(100));
            }
            if (interrupted()) return static_cast<int>(code);
            if (scenes.revision() != scenes_seen || kernels->revision() != kernels_seen) {
                const FileWatch& from = scenes.revision() != scenes_seen ? scenes : *kernels;
                for (const std::string& path : from.last_changed()) log(LogLevel::info, "changed: " + path);
            }
            if (scenes.revision() != scenes_seen) scene_.take(nullptr);
            // The new library of a structure may have other kernel files.
            if (take_libraries(libraries)) kernels = std::make_unique<KernelWatch>(plugins_.accels(), changed);
        }
    }

    // Puts rebuilt plugin libraries into force; files are read again by a rebuilt importer. Returns whether there was a
    // structure.
    bool take_libraries(LibraryWatch& libraries) {
        bool structures = false;
        for (const RebuiltLibrary& library : libraries.apply()) {
            if (!library.now) {
                log(LogLevel::error, library.why);
            } else if (library.now->importer) {
                scene_.take(nullptr);
            } else {
                structures = true;
                if (library.before && words_.settings.accel == library.now->id)
                    words_.settings.accel_params =
                        carried_parameters(*library.before, *library.now, words_.settings.accel_params);
            }
        }
        stats_.settings = settings_;
        return structures;
    }

    // Runs a round. Reports a failure as a message and returns its exit code, so that the watch goes on with the next save.
    Exit guarded_round(const std::function<bool()>& saved) {
        superseded_ = saved;
        UntilSaved progress(bar_, saved);
        const auto fail = [&](Exit code, const std::string& message, const std::string& details) {
            bar_.clear();
            log(LogLevel::error, message);
            if (!details.empty()) log(LogLevel::info, details);
            return code;
        };
        try {
            if (preparer_ && preparer_->needs_reopen()) reopen_devices();
            stats_.frame_ms.clear();
            stats_.wall_ms.clear();
            return round(progress);
        } catch (const Cancelled&) {
            return Exit::interrupted;
        } catch (const Error& e) {
            return fail(e.code(), e.what(), e.details());
        } catch (const std::exception& e) {
            return fail(Exit::failed, std::string("unexpected failure: ") + e.what(), {});
        }
    }

    void take_devices(const Devices& devices) {
        devices_ = devices;
        stats_.devices = infos_of(devices);
    }

    // A device closes when its last owner releases it, so everything which holds one goes first.
    void reopen_devices() {
        blur_.reset();
        prepared_.reset();
        stats_.prepared.reset();
        take_devices({});
        take_devices(open_devices(preparer_->close_devices()));
        preparer_->open_devices(devices_);
    }

    void import(Progress& progress) {
        const auto begin = Clock::now();
        scene_.take(std::make_shared<const Scene>(
            import::import_scene(plugins_, options_.scene.files, options_.scene.import, progress)));
        stats_.import_ms = ms_since(begin);
    }

    void prepare(Progress& progress) {
        if (!preparer_) preparer_ = std::make_unique<MultiPreparer>(plugins_, devices_);
        blur_.reset();
        prepared_ = preparer_->prepare(scene_.scene(), settings_, progress);
        stats_.prepared = prepared_->first();
        blur_ = scene_.blur(prepared_, *preparer_);
        const Prepared& prepared = *stats_.prepared;
        char line[160];
        std::snprintf(line, sizeof line, "import %.0f ms, build %.0f ms, upload %.0f ms, compile %.0f ms%s", stats_.import_ms,
                      prepared.accel->build_ms, prepared.upload_ms, prepared.compile_ms,
                      prepared.compile_cached ? " (cached)" : "");
        log(LogLevel::debug, line);
    }

    // Renders one picture, with --repeat several times. Returns false if interrupted; the samples done so far are then written.
    bool render(MultiFrameRenderer& frames, int number, Progress& progress) {
        bar_.stage("rendering " + std::filesystem::path(frame_path(options_.output, number)).filename().string());
        // The first pass counts rays, which costs a little time, and warms up caches; timed passes come after it.
        const bool warm_up = options_.repeat > 1;
        const unsigned passes = options_.repeat + (warm_up ? 1 : 0);
        unsigned samples = 0;
        for (unsigned pass = 0; pass < passes; ++pass) {
            const bool count = pass == 0, timed = !(warm_up && pass == 0);
            samples = trace_pass(frames, count, timed, double(pass) / passes, 1.0 / passes, progress);
            if (samples < unsigned(settings_.spp)) break;
        }
        const bool whole = samples == unsigned(settings_.spp);
        bar_.clear();
        if (!whole && !interrupted() && superseded_ && superseded_()) return false;  // the next round writes it
        // A picture with fewer samples than asked for would be taken for a whole one the next time.
        const bool keep = samples > 0 && (whole || !options_.skip_existing);
        if (keep) {
            if (!whole) take_time_to_stop();
            write(frames, number);
        }
        if (!whole)
            log(LogLevel::warning,
                "interrupted: " + (!keep ? (samples == 0 ? "no sample was complete" : "the picture was not complete") +
                                               std::string(", nothing is written")
                                         : frame_path(options_.output, number) + " holds " + std::to_string(samples) + " of " +
                                               std::to_string(settings_.spp) + " samples a pixel"));
        return whole;
    }

    FrameStats trace_samples(MultiFrameRenderer& frames, unsigned first, unsigned how_many, bool count, Progress& progress) {
        if (!blur_) return frames.trace(prepared_, settings_, scene_.view(), first, count, progress, how_many);
        FrameStats stats;
        for (unsigned i = first; i < first + how_many; ++i) {
            PartOf part(progress, double(i - first) / how_many, 1.0 / how_many);
            const MotionBlur::Sample& sample = blur_->at(i, scene_.view(), part);
            const FrameStats one = frames.trace(sample.prepared, settings_, scene_.view(sample), i, count, part);
            add_stats(stats, one);
            add_shares(stats.devices, one.devices);
        }
        return stats;
    }

    // Traces all samples of one frame. Returns the number of complete samples.
    unsigned trace_pass(MultiFrameRenderer& frames, bool count, bool timed, double from, double share, Progress& progress) {
        if (count) stats_.primary = stats_.shadow = stats_.secondary = stats_.dropped = stats_.overflowed = 0;
        double device_ms = 0, wall_ms = 0;
        const auto all = unsigned(settings_.spp);
        std::vector<DeviceShare> devices;
        for (unsigned sample = 0, next = std::min(all, 2u); sample < all;
             sample += std::exchange(next, batch(wall_ms, sample + next))) {
            const double at = from + share * sample / all;
            // A short sample is one launch, during which cancelling is not checked.
            if (!progress.report(float(at))) return sample;
            PartOf part(progress, at, share * next / all);
            FrameStats frame;
            try {
                frame = trace_samples(frames, sample, next, count, part);
            } catch (const Cancelled&) {
                return frames.samples();
            } catch (const SamplesLost&) {
                return trace_pass(frames, count, timed, from, share, progress);
            }
            device_ms += frame.device_ms;
            wall_ms += frame.wall_ms;
            add_shares(devices, frame.devices);
            if (count) {
                stats_.primary += frame.primary;
                stats_.shadow += frame.shadow;
                stats_.secondary += frame.secondary;
                stats_.dropped += frame.dropped;
                stats_.overflowed += frame.overflowed;
            }
        }
        stats_.shares = devices;
        if (timed) {
            stats_.frame_ms.push_back(device_ms);
            stats_.wall_ms.push_back(wall_ms);
        }
        return all;
    }

    // Number of samples to trace in the next batch, after `done` samples took wall_ms: about 100 ms. Longer batches delay the
    // progress bar; shorter ones make several devices wait for each other more often.
    unsigned batch(double wall_ms, unsigned done) const {
        constexpr double kBatchMs = 100;
        const double each = std::max(wall_ms / done, 1e-3);
        return std::min(unsigned(std::clamp(kBatchMs / each, 1.0, 1024.0)),
                        unsigned(settings_.spp) - std::min(done, unsigned(settings_.spp)));
    }

    static void add_shares(std::vector<DeviceShare>& sum, const std::vector<DeviceShare>& more) {
        if (sum.size() != more.size()) sum.assign(more.size(), {});
        for (size_t i = 0; i < more.size(); ++i) {
            DeviceShare total = more[i];
            total.device_ms += sum[i].device_ms;
            total.wall_ms += sum[i].wall_ms;
            total.launches += sum[i].launches;
            sum[i] = total;
        }
    }

    void write(MultiFrameRenderer& frames, int number) {
        const std::string path = frame_path(options_.output, number);
        const bool png = writes_display(path);
        const FloatImage values = png ? FloatImage{} : frames.read_values();
        const ByteImage display = png ? frames.read_display(settings_) : ByteImage{};
        if (stats_.first_picture_ms == 0) stats_.first_picture_ms = ms_since(begin_);
        write_image(path, values, display);
        char times[96] = "";
        if (!stats_.frame_ms.empty())
            std::snprintf(times, sizeof times, "  %.2f ms, %.1f Mrays/s", median_frame_ms(stats_), mrays_per_s(stats_));
        log(LogLevel::info, path + times);
    }

    void report() {
        if (stats_.dropped > 0)
            log(LogLevel::warning, std::to_string(stats_.dropped) +
                                       " rays were dropped because a pixel's ray slots were full: raise --ray-slots (now " +
                                       std::to_string(settings_.ray_slots) + ")");
        if (stats_.overflowed > 0)
            log(LogLevel::error,
                std::to_string(stats_.overflowed) + " times a traversal stack was full: a fault of accel " + settings_.accel);
        if (options_.stats_file.empty()) return;
        const std::string json = stats_json(stats_);
        if (options_.stats_file == "-")
            std::fwrite(json.data(), 1, json.size(), stdout);
        else
            write_text_file(options_.stats_file, json);
    }

    const RenderOptions& options_;
    const Clock::time_point begin_ = Clock::now();
    TraceWords words_;
    const Settings& settings_;
    const FrameRange range_;
    const PluginRegistry& plugins_;
    ProgressBar bar_;
    Devices devices_;
    std::function<bool()> superseded_;  // with --watch: true if a save has made this round obsolete
    FrameScene scene_;
    std::unique_ptr<MultiPreparer> preparer_;
    std::shared_ptr<const MultiPrepared> prepared_;
    std::unique_ptr<MotionBlur> blur_;  // nullptr: all samples of a picture are at one time
    RenderStats stats_;
};

}  // namespace

int run_render(const PluginRegistry& plugins, const RenderOptions& options) {
    return RenderJob(plugins, options).run();
}

}  // namespace clarity
