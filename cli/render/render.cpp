// clarity render: renders a scene to picture files, without a window.
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/file_watch.hpp"
#include "base/files/frame_path.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "cli/render/frame_claim.hpp"
#include "cli/render/frame_output.hpp"
#include "cli/render/frame_record.hpp"
#include "cli/render/frame_scene.hpp"
#include "cli/render/picture_checkpoint.hpp"
#include "cli/render/picture_digest.hpp"
#include "cli/render/picture_goal.hpp"
#include "cli/render/picture_tracer.hpp"
#include "cli/render/render_checks.hpp"
#include "cli/render/render_progress.hpp"
#include "cli/render/render_stats.hpp"
#include "device/kernel_watch.hpp"
#include "launch/prepared.hpp"
#include "mpi/mpi_ranks.hpp"
#include "picture/film_noise.hpp"
#include "plugin/library_watch.hpp"
#include "stand/multi_frame_renderer.hpp"
#include "view/settings/aov.hpp"
#include "view/view.hpp"

namespace clarity {
namespace {

using Clock = std::chrono::steady_clock;

class RenderJob {
 public:
    // mpi: the ranks of which this process is one; nullptr: it renders alone.
    RenderJob(const PluginRegistry& plugins, const RenderOptions& options, MpiRanks* mpi)
        : options_(options),
          mpi_(mpi),
          words_(read_trace_options(plugins, options_.trace)),
          settings_(words_.settings),
          range_(frames_of(options_)),
          plugins_(plugins),
          bar_(options_.quiet || !is_first()),
          scene_(plugins, options_, words_, bar_) {
        if (ends_by_itself(options_, settings_) && !states_samples(options_))
            words_.settings.spp = int(find_setting("spp")->max);
        if (!options_.crop.empty()) crop_picture(words_.settings, options_.crop);
        stats_.files = options_.scene.files;
        stats_.settings = settings_;
    }

    int run() {
        check_render_options(options_, settings_, range_);
        if (!options_.reference.empty()) stats_.reference = std::make_shared<ReferenceRun>(options_.reference, settings_);
        if (is_first()) check_scene(plugins_, options_.scene);
        if (range_.count() == 0) {
            log(LogLevel::info, "--frames-of " + options_.frames_of + ": there are fewer frames, so that this share is empty");
            return static_cast<int>(Exit::done);
        }
        const CancelOnSignal cancel(bar_);
        const std::vector<DeviceInfo> chosen = choose_devices(words_.device);
        take_devices(open_devices(mpi_ ? mpi_->own(chosen) : chosen));
        for (const DeviceInfo& info : stats_.devices) log(LogLevel::debug, "device " + info.id() + " " + info.name);
        if (options_.watch) return watch();
        return static_cast<int>(round(bar_));
    }

 private:
    // Imports, builds and compiles what is not up to date, then renders all pictures.
    Exit round(Progress& progress) {
        if (!scene_.imported()) import(progress);
        moving_ = scene_.follows_frames();
        PictureDigests digests(scene_, settings_, options_);
        std::optional<MultiFrameRenderer> frames;  // made when its program has been compiled, which prepare() can cancel
        std::vector<int> left;
        for (long number = range_.first; number <= range_.last; number += range_.step) left.push_back(int(number));
        for (long rendered = 0;;) {
            std::vector<int> claimed;  // by other processes
            for (const int number : left) {
                if (progress.cancelled()) throw Cancelled();
                const std::optional<int> shown = moving_ ? std::optional<int>(number) : std::nullopt;
                const std::string& digest = digests.of(shown);
                std::unique_ptr<FrameClaim> claim;
                const Todo todo = of_first(is_first() ? todo_of(number, digest, claim) : Todo::render);
                if (todo == Todo::wait) claimed.push_back(number);
                if (todo != Todo::render) continue;
                const auto begin = Clock::now();
                if (moving_ || !scene_.placed()) scene_.place(shown);
                if (rendered == 0) note_sizes();
                if (moving_ || rendered == 0) prepare(progress);
                if (!frames) frames.emplace(devices_, mpi_);
                if (!render(*frames, {number, digest, begin}, progress)) return Exit::interrupted;
                ++rendered;
            }
            left = std::move(claimed);
            if (left.empty()) {
                if (rendered > 0) report();
                return tell_skipped(rendered);
            }
            wait_for_others(left.size(), progress);
        }
    }

    // Of several ranks the first decides, writes files and speaks.
    bool is_first() const { return !mpi_ || mpi_->rank() == 0; }

    enum class Todo { render, skip, wait };
    Todo of_first(Todo todo) const { return mpi_ ? static_cast<Todo>(int(mpi_->gather(double(todo))[0])) : todo; }
    // What is done about a frame; wait: another process has claimed it.
    Todo todo_of(int number, const std::string& digest, std::unique_ptr<FrameClaim>& claim) const {
        if (!options_.skip_existing) return Todo::render;
        if (is_there(number, digest)) return Todo::skip;
        claim = FrameClaim::take(frame_path(options_.output, number));
        if (!claim) return Todo::wait;
        return is_there(number, digest) ? Todo::skip : Todo::render;  // the process that had the claim may just have finished
    }

    // Whether frames are recorded, and their pictures have their names only when they are complete.
    bool records() const { return !options_.frames.empty() || options_.skip_existing; }

    bool is_there(int number, const std::string& digest) const {
        const std::string path = frame_path(options_.output, number);
        if (!is_rendered(path, digest)) return false;
        FrameClaim::remove_expired(path);
        return true;
    }

    // Waits a moment until other processes have finished their frames, or their claims have expired.
    void wait_for_others(size_t how_many, const Progress& progress) {
        if (!std::exchange(waits_, true))
            log(LogLevel::info, std::to_string(how_many) + " of " + std::to_string(range_.count()) +
                                    " pictures are being rendered by other processes; waiting for them");
        for (int i = 0; i < 5 && !progress.cancelled(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
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
            if (interrupted()) {
                take_time_to_stop();  // nothing is launched: only a busy machine makes the end slow
                return static_cast<int>(code);
            }
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
        const auto import = [&] {
            const import::ImportOptions options = import_options(options_.scene, words_);
            Scene scene = import::import_scene(plugins_, options_.scene.files, options, progress);
            stats_.import_ms = ms_since(begin);
            return scene;
        };
        scene_.take(std::make_shared<const Scene>(mpi_ ? mpi_->share_scene(plugins_, import, progress) : import()));
        stats_.share_ms = ms_since(begin) - stats_.import_ms;
    }

    // nullptr if this rank has to build its own structure, which may be of another kind than that of the host's first rank.
    std::shared_ptr<const AccelData> share_structure(Progress& progress) {
        const auto accel = mpi_->share_structure(plugins_, preparer_->builder(settings_), *scene_.scene(), progress);
        return accel && preparer_->asks_for(*accel, settings_) ? accel : nullptr;
    }

    void prepare(Progress& progress) {
        const auto begin = Clock::now();
        if (!preparer_) preparer_ = std::make_unique<MultiPreparer>(plugins_, devices_);
        blur_.reset();
        const auto shared = mpi_ ? share_structure(progress) : nullptr;
        words_.settings.optics = optics_of(*scene_.scene(), scene_.view(), settings_);
        prepared_ = preparer_->prepare(scene_.scene(), settings_, progress, shared);
        stats_.prepared = prepared_->first();
        blur_ = scene_.blur(prepared_, *preparer_);
        stats_.prepare_ms = ms_since(begin);
        const Prepared& prepared = *stats_.prepared;
        char line[160];
        std::snprintf(line, sizeof line, "import %.0f ms, build %.0f ms, upload %.0f ms, compile %.0f ms%s", stats_.import_ms,
                      prepared.accel->build_ms, prepared.upload_ms, prepared.compile_ms,
                      prepared.compile_cached ? " (cached)" : "");
        log(LogLevel::debug, line);
    }

    // Once for each scene.
    void note_sizes() const {
        const std::string note = size_note(scene_.view().lights, settings_.tracer);
        if (!note.empty() && is_first()) log(LogLevel::warning, note);
    }

    struct Frame {
        int number;
        std::string digest;
        Clock::time_point begin;
    };

    // Renders one picture, with --repeat several times. Returns false if interrupted. The samples done so far are then in the
    // checkpoint; without one, they are written as the picture, unless pictures have to be complete.
    bool render(MultiFrameRenderer& frames, const Frame& frame, Progress& progress) {
        const std::string path = frame_path(options_.output, frame.number);
        bar_.stage("rendering " + std::filesystem::path(path).filename().string());
        const auto all = unsigned(settings_.spp);
        PictureCheckpoint checkpoint(options_, frame.number, frame.digest, way_of_tracing(stats_.devices, *prepared_), all,
                                     mpi_);
        resumed_ = 0;
        if (mpi_) gather_prepare_times(stats_, *mpi_);
        if (mpi_) say_at_deadline(words_of_rank(checkpoint));
        // The first pass counts rays, which costs a little time, and warms up caches; timed passes come after it.
        const bool warm_up = options_.repeat > 1;
        const unsigned passes = options_.repeat + (warm_up ? 1 : 0);
        PictureTracer::Traced traced{all, true, true};
        for (unsigned pass = 0; pass < passes && traced.whole; ++pass)
            traced = trace_pass(frames, checkpoint, pass == 0, !(warm_up && pass == 0), double(pass) / passes, 1.0 / passes,
                                progress);
        const bool whole = traced.whole;
        stats_.samples = traced.samples;
        stats_.noise.reset();
        if (whole && frames.planes() > 1) stats_.noise = frames.noise();
        if (stats_.reference && traced.exact && traced.samples > 0) stats_.reference->offer(frames, traced.samples, true);
        bar_.clear();
        if (!whole && !interrupted() && superseded_ && superseded_()) return false;  // the next round writes it
        if (!whole) take_time_to_stop();
        if (!whole && checkpoint.saves()) {
            // Ranks stop at different samples.
            if (!mpi_ && traced.exact && traced.samples > checkpoint.saved()) checkpoint.save(frames, traced.samples);
            tell_interrupted(checkpoint.saved() == 0
                                 ? "no sample was complete, nothing is written"
                                 : checkpoint.path() + " holds " + std::to_string(checkpoint.saved()) + " of " +
                                       std::to_string(all) + " samples a pixel; the same command with --resume " +
                                       checkpoint.path() + " goes on with them");
            return false;
        }
        // A picture with fewer samples than asked for would be taken for a whole one the next time.
        const bool partial = !whole && traced.samples > 0 && !records() && !mpi_;
        if (whole || partial) write(frames, frame, path, progress);
        if (whole)
            checkpoint.remove();
        else if (partial)
            tell_interrupted(path + " holds " + std::to_string(traced.samples) + " of " + std::to_string(all) +
                             " samples a pixel");
        else
            tell_interrupted((traced.samples == 0 ? "no sample was complete" : "the picture was not complete") +
                             std::string(", nothing is written"));
        return whole;
    }

    // Rank 0 waits for ranks that have ended; mpirun then ends it, too.
    std::string words_of_rank(const PictureCheckpoint& checkpoint) const {
        if (!is_first()) return {};
        const std::string what = "not all ranks have stopped in time; the picture is not written; ";
        return what + (checkpoint.saves() ? "once " + checkpoint.path() + " is there, the same command with --resume " +
                                                checkpoint.path() + " goes on with its samples"
                                          : "with --checkpoint FILE, the same command with --resume FILE would go on");
    }

    void tell_interrupted(const std::string& what) const {
        if (is_first()) log(LogLevel::warning, "interrupted: " + what);
    }

    PictureTracer::Traced trace_pass(MultiFrameRenderer& frames, PictureCheckpoint& checkpoint, bool counts, bool timed,
                                     double from, double share, Progress& progress) {
        PictureTracer::Pass pass;
        pass.counts = counts, pass.timed = timed, pass.from = from, pass.share = share;
        pass.at_most_doubles = stats_.reference != nullptr;
        if (checkpoint.saves() || stats_.reference)
            pass.between = [&](unsigned samples) {
                if (checkpoint.saves()) checkpoint.offer(frames, samples);
                if (stats_.reference) stats_.reference->offer(frames, samples, false);
            };
        if (ends_by_itself(options_, settings_)) pass.more = [&](unsigned samples) { return goal_.more(frames, samples); };
        for (;;) {
            pass.first = resumed_ = checkpoint.resume(frames, prepared_, settings_);
            if (stats_.reference) stats_.reference->begin();
            goal_.begin(pass.first);
            try {
                return PictureTracer(frames, settings_, stats_, mpi_).trace({prepared_, scene_, blur_.get()}, pass, progress);
            } catch (const SamplesLost&) {  // of a device that takes no further part: the other devices begin again
            }
        }
    }

    void write(MultiFrameRenderer& frames, const Frame& frame, const std::string& path, Progress& progress) {
        if (mpi_) gather_frame_times(stats_, *mpi_);
        const auto all_done = Clock::now();
        FramePixels pixels;
        if (writes_display(path))
            pixels.display = frames.read_display(settings_);
        else
            pixels.values = frames.read_picture(settings_);
        if (!options_.stats_file.empty() && find_aov(settings_.aov).about == Aov::About::cost)
            stats_.cost = cost_of(writes_display(path) ? frames.read_values() : pixels.values);
        if (options_.all_aovs)
            pixels.layers = trace_aov_layers(frames, *preparer_, scene_.scene(), scene_.view(), settings_, progress);
        stats_.collect_ms = ms_since(all_done);
        if (!is_first()) return;
        if (stats_.first_picture_ms == 0) stats_.first_picture_ms = ms_since(begin_);
        FrameFile file;
        file.path = path, file.digest = frame.digest, file.frame = frame.number, file.moves = moving_;
        file.samples = stats_.samples, file.of_checkpoint = resumed_, file.noise = stats_.noise;
        file.device = devices_name(stats_.devices);
        file.has_record = records();
        file.denoised = denoises(settings_);
        file.begin = frame.begin;
        write_frame(options_, file, std::move(pixels));
        char times[96] = "";
        if (!stats_.frame_ms.empty())
            std::snprintf(times, sizeof times, "  %.2f ms, %.1f Mrays/s", median_frame_ms(stats_), mrays_per_s(stats_));
        log(LogLevel::info, path + times + samples_text());
    }

    // How many samples a picture has that ends by itself. Of those that rest, pixels have fewer.
    std::string samples_text() const {
        if (!ends_by_itself(options_, settings_)) return {};
        if (adaptive_bound(settings_) > 0 && stats_.noise) {
            char text[96];
            std::snprintf(text, sizeof text, "  %.4g samples a pixel on average, %u at most", stats_.noise->mean_samples,
                          stats_.samples);
            return text;
        }
        return "  " + plural(stats_.samples, "sample") + " a pixel";
    }

    void report() {
        if (!is_first()) return;
        if (stats_.dropped > 0)
            log(LogLevel::warning, dropped_text(stats_.dropped, settings_.tracer == "path" ? 0 : settings_.ray_slots));
        if (stats_.overflowed > 0)
            log(LogLevel::error,
                plural(stats_.overflowed, "time") + " a traversal stack was full: a fault of accel " + settings_.accel);
        if (options_.stats_file.empty()) return;
        const std::string json = stats_json(stats_);
        if (options_.stats_file == "-")
            std::fwrite(json.data(), 1, json.size(), stdout);
        else
            write_text_file(options_.stats_file, json);
    }

    const RenderOptions options_;
    MpiRanks* const mpi_;
    const Clock::time_point begin_ = Clock::now();
    TraceWords words_;
    const Settings& settings_;
    const FrameRange range_;
    const PluginRegistry& plugins_;
    ProgressBar bar_;
    Devices devices_;
    std::function<bool()> superseded_;  // with --watch: true if a save has made this round obsolete
    FrameScene scene_;
    bool moving_ = false;   // each frame shows the scene at a time of its own
    bool waits_ = false;    // the user has been told that other processes render
    unsigned resumed_ = 0;  // samples of the picture that a checkpoint had
    std::unique_ptr<MultiPreparer> preparer_;
    std::shared_ptr<const MultiPrepared> prepared_;
    PictureGoal goal_{options_, settings_, mpi_};
    std::unique_ptr<MotionBlur> blur_;  // nullptr: all samples of a picture are at one time
    RenderStats stats_;
};

}  // namespace

int run_render(const PluginRegistry& plugins, const RenderOptions& options) {
    if (options.verify) return run_verify(plugins, options);
    if (!options.mpi) return RenderJob(plugins, with_all_aovs(options), nullptr).run();
    MpiRanks ranks;
    const int code = RenderJob(plugins, with_all_aovs(options), &ranks).run();
    if (code == static_cast<int>(Exit::done)) ranks.finish();
    return code;
}

}  // namespace clarity
