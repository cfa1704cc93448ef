#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "api/handles.hpp"
#include "base/elapsed.hpp"
#include "base/log.hpp"
#include "device/cl_errors.hpp"
#include "launch/prepared.hpp"
#include "view/settings/accel_choice.hpp"
#include "view/settings/aov.hpp"
#include "view/view.hpp"

namespace clarity::api {

void read_words(const char* const* texts, Words& words) {
    for (; texts && *texts; ++texts) {
        const std::string pair = *texts;
        const size_t equals = pair.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Error(Exit::usage, "setting `" + pair + "`: expected key=value, as in shadows=false");
        const std::string key = pair.substr(0, equals), value = pair.substr(equals + 1);
        if (is_edit(key))
            words.edits.push_back({key, value});
        else
            set_setting(words.settings, key, value);
    }
}

namespace {

// Rays are traced in batches, so that a cancel is heard and memory stays small: batches that take about kBatchMs, of a size
// that all numbers of lanes divide.
constexpr size_t kFirstBatch = size_t{1} << 14, kMostBatch = size_t{1} << 22;
constexpr double kBatchMs = 50;

// Packed rays lie in few large pieces, because each costs a launch and a wait for it; the launcher cuts what takes long. A
// piece has a small share of the device's memory: its answers may need a buffer, too.
size_t packed_at_once(const DeviceInfo& device) {
    constexpr uint64_t kShare = 64, kMost = uint64_t{1} << 27;  // kernels count in 32 bits
    const uint64_t room = std::min(device.global_bytes / kShare, device.max_allocation_bytes) / sizeof(rt_ray);
    size_t rays = kMostBatch;
    while (2 * rays <= std::min(room, kMost)) rays *= 2;
    return rays;
}

// Buffers are made once for all batches that rays may have, in few sizes: the memory of a buffer that has become too small is
// kept (base/aligned_bytes.hpp), so buffers that grow with the batches take twice as much. Pages that no batch uses are no
// memory on a CPU.
size_t room_for(size_t rays) {
    if (rays <= kFirstBatch) return rays;
    size_t room = kFirstBatch;
    while (room < std::min(rays, kMostBatch)) room *= 2;
    return room;
}

Settings settings_of(const clarity_options& options) {
    Words words;
    read_words(options.settings, words);
    if (!words.edits.empty())
        throw Error(Exit::usage, "setting `" + words.edits.front().key +
                                     "`: a tracer has no camera, lights or materials; give it to clarity_render()");
    if (const std::string accel = text_of(options.accel); !accel.empty()) choose_accel(plugins(), accel, words.settings);
    return words.settings;
}

// The list of devices is made by one thread at a time: making it loads drivers, and sets a variable of the environment.
std::shared_ptr<Device> open_device(const std::string& choice) {
    static std::mutex& mutex = *new std::mutex;
    const std::lock_guard<std::mutex> lock(mutex);
    return std::make_shared<Device>(choose_device(choice));
}

// A setting that does nothing for the picture is a mistake of the caller, which nothing else would tell; but `off` is what
// there is. texts: of the call; the tracer's own settings serve other pictures, too.
void check_used(const char* const* texts, const Settings& settings) {
    for (; texts && *texts; ++texts) {
        const std::string pair = *texts, key = pair.substr(0, pair.find('='));
        const Setting* const setting = find_setting(key);
        if (!setting || setting->get(settings) == "off") continue;
        if (!setting->used(settings))
            throw Error(Exit::usage, "setting `" + key + "`: it is for the tracer `" + setting->picture +
                                         "` alone, and this picture is by `" + settings.tracer +
                                         "`: add tracer=" + setting->picture + ", or leave it out");
        if (key == "denoise" && settings.denoise == "on" && !denoises(settings))
            throw Error(Exit::usage, "setting `denoise`: it filters colours, and this picture shows `" + settings.aov + "`");
    }
}

rt_u32 mask_of(const clarity_rays& rays) {
    return rays.mask ? rays.mask : RT_SEEN_BY_ALL;
}

}  // namespace
}  // namespace clarity::api

using namespace clarity;
using namespace clarity::api;

clarity_tracer::clarity_tracer(const clarity_scene& scene, const clarity_options& options, Progress& progress)
    : imported_(scene.imported),
      placed_(scene.placed),
      settings_(settings_of(options)),
      device_(open_device(text_of(options.device))),
      preparer_(plugins(), {device_}),
      queries_(device_),
      keeping_(std::make_shared<KeepingDevice>(queries_.copies())),
      of_arrays_(scene.of_arrays),
      batch_(kFirstBatch) {
    check_arrays();
    const auto accel = preparer_.build(placed_, settings_, progress);
    prepared_ = prepare_queries(*device_, placed_, accel, settings_, progress);
    prepared_id_ = new_packing();
}

void clarity_tracer::check_arrays() const {
    if (!of_arrays_) return;
    if (const Problem why = validate(*placed_))
        throw Error(Exit::usage, "the arrays of the scene were changed after it was made, and are no mesh now: " + why.text());
}

void clarity_tracer::check(const clarity_rays& rays) const {
    check_rays(rays);
    if (rays.packed && rays.packed->tracer != id_)
        throw Error(Exit::usage, "the packed rays are those of another tracer: pack them with this one");
    if (rays.packed && rays.packed->count != rays.count)
        throw Error(Exit::usage, "clarity_rays::count is " + std::to_string(rays.count) + ", and the packed rays are " +
                                     std::to_string(rays.packed->count));
}

RayQuery clarity_tracer::query_of(const clarity_rays& rays, Wanted wanted, Progress& progress) const {
    RayQuery query;
    query.any_hit = wanted == Wanted::occlusion;
    query.brief = wanted == Wanted::nearest;
    query.mask = mask_of(rays);
    query.progress = &progress;
    return query;
}

void clarity_tracer::trace(const clarity_rays& rays, const RayQuery& query, const TakeAnswers& take, const Answers* all) {
    query.progress->stage("tracing rays");
    size_t first = 0;
    const auto trace_some = [&](RayArrays some) {
        if (!query.progress->report(float(first) / float(rays.count))) throw Cancelled();
        some.prepared = prepared_id_;
        some.all = all;
        some.first = first;
        Answers answers;
        const double ms = queries_.trace(*prepared_, some, query, answers);
        traced_ms_ += ms;
        device_ms_ += ms;
        rays_ += some.count;
        if (!all)
            wrap_cl_errors(*device_, "reading hits", [&] {
                take(first, answers);
                return 0;
            });
        first += some.count;
    };
    if (rays.packed) {
        for (const clarity_packed::Piece& piece : rays.packed->pieces)
            trace_some({piece.count, piece.packing, piece.rays, {}, room_for(piece.count)});
        return;
    }
    while (first < rays.count) {
        const auto begin = std::chrono::steady_clock::now();
        const size_t count = std::min(batch_, size_t(rays.count) - first);
        trace_some({count, id_, {}, reader(rays, first), room_for(rays.count)});
        const double ms = ms_since(begin);
        if (ms > 2 * kBatchMs) batch_ = std::max(batch_ / 2, kFirstBatch / 16);
        if (ms < kBatchMs / 2 && count == batch_) batch_ = std::min(batch_ * 2, kMostBatch);
    }
}

void clarity_tracer::trace(const clarity_rays& rays, Wanted wanted, Progress& progress, const TakeAnswers& take) {
    check(rays);
    const std::lock_guard<std::mutex> lock(keeping_->calls);
    trace(rays, query_of(rays, wanted, progress), take, nullptr);
}

void clarity_tracer::keep(const clarity_rays& rays, clarity_kept& kept, Progress& progress) {
    check(rays);
    if (!kept.of(*keeping_)) throw Error(Exit::usage, "the kept hits are those of another tracer: this one needs others");
    const std::lock_guard<std::mutex> own(kept.own);
    const std::lock_guard<std::mutex> lock(keeping_->calls);
    const RayQuery query = query_of(rays, kept.brief ? Wanted::nearest : Wanted::hits, progress);
    const Answers& answers = kept.begin(rays.count, RayQueries::answer_fields(*prepared_, query));
    if (answers.buffer()) {
        trace(rays, query, {}, &answers);
    } else {
        const AnswersTo to = kept.host();
        trace(
            rays, query, [&](size_t first, const Answers& some) { read_answers(*queries_.copies(), some, to.from(first)); },
            nullptr);
    }
    kept.end();
}

ReadRays clarity_tracer::reader(const clarity_rays& rays, size_t begin) const {
    return [&rays, begin, this](size_t first, size_t count, rt_ray* to) {
        read_rays(rays, begin + first, count, placed_->origin, to);
    };
}

std::unique_ptr<clarity_packed> clarity_tracer::pack(const clarity_rays& rays, Progress& progress) {
    check_rays(rays);
    if (rays.packed) throw Error(Exit::usage, "the rays are packed already");
    const std::lock_guard<std::mutex> lock(keeping_->calls);
    progress.stage("packing rays");
    auto packed = std::make_unique<clarity_packed>(clarity_packed{id_, device_, {}, rays.count});
    const size_t at_once = packed_at_once(device_->info());
    for (size_t first = 0; first < rays.count; first += at_once) {
        const size_t count = std::min(at_once, size_t(rays.count) - first);
        const auto read = [&, read_all = reader(rays, first)](size_t begin, size_t some, rt_ray* to) {
            if (begin % kFirstBatch == 0) progress.report(float(first + begin) / float(rays.count));
            if (progress.cancelled()) throw Cancelled();
            read_all(begin, some, to);
        };
        packed->pieces.push_back({count, queries_.pack_on_device(count, prepared_->layout.lanes, read), new_packing()});
    }
    return packed;
}

const char* clarity_tracer::info() {
    const std::lock_guard<std::mutex> lock(keeping_->calls);
    const AccelData& accel = *prepared_->accel;
    const HostCopies& copies = *queries_.copies();
    nlohmann::ordered_json json = {{"device", device_->info().name},
                                   {"device_id", device_->info().id()},
                                   {"accel", accel.plugin->id},
                                   {"lanes", prepared_->layout.lanes},
                                   {"build_ms", accel.build_ms},
                                   {"accel_bytes", accel.bytes},
                                   {"accel_stats", nlohmann::ordered_json::object()},
                                   {"rays", rays_},
                                   {"device_ms", device_ms_},
                                   {"bytes_to_device", copies.bytes_written()},
                                   {"bytes_from_device", copies.bytes_read()}};
    for (const auto& [label, value] : accel.stats) json["accel_stats"][label] = value;
    // Another thread may ask while this one still reads.
    std::string& info = infos_[std::this_thread::get_id()];
    info = json.dump(2);
    return info.c_str();
}

void clarity_tracer::closest(const clarity_rays& rays, const clarity_hits& hits, Progress& progress) {
    const Wanted wanted = hits.instance || hits.uv ? Wanted::hits : Wanted::nearest;
    const AnswersTo to = {{hits.t, hits.prim, hits.uv, hits.instance}};
    trace(rays, wanted, progress,
          [&](size_t first, const Answers& some) { read_answers(*queries_.copies(), some, to.from(first)); });
}

void clarity_tracer::any(const clarity_rays& rays, uint8_t* occluded, Progress& progress) {
    if (rays.count > 0) not_null(occluded, "occluded");
    trace(rays, Wanted::occlusion, progress,
          [&](size_t first, const Answers& some) { read_occlusion(*queries_.copies(), some, occluded + first); });
}

template <class Take>
void clarity_tracer::trace_all(const clarity_rays& rays, bool count_only, Progress& progress, const Take& take) {
    constexpr size_t kAtOnce = size_t{1} << 16;
    check_rays(rays);
    if (rays.packed) throw Error(Exit::usage, "packed rays serve clarity_closest() and clarity_any(): give the arrays");
    const std::lock_guard<std::mutex> lock(keeping_->calls);
    progress.stage(count_only ? "counting the hits of rays" : "tracing rays for all their hits");
    for (size_t first = 0; first < rays.count; first += kAtOnce) {
        if (!progress.report(float(first) / float(rays.count))) throw Cancelled();
        std::vector<rt_ray> some(std::min(kAtOnce, size_t(rays.count) - first));
        read_rays(rays, first, some.size(), placed_->origin, some.data());
        take(queries_.trace_all(*prepared_, some, {count_only, false, mask_of(rays)}, progress), first);
    }
}

void clarity_tracer::count(const clarity_rays& rays, int64_t* counts, Progress& progress) {
    if (rays.count > 0) not_null(counts, "counts");
    trace_all(rays, true, progress, [&](const AllHits& some, size_t first) {
        for (size_t i = 0; i + 1 < some.first.size(); ++i) counts[first + i] = static_cast<int64_t>(some.count(i));
    });
}

std::unique_ptr<HitArrays> clarity_tracer::all(const clarity_rays& rays, Progress& progress) {
    auto hits = std::make_unique<HitArrays>();
    trace_all(rays, false, progress, [&](const AllHits& some, size_t) { append_hits(some, *hits); });
    return hits;
}

View clarity_tracer::view_of(const clarity_picture& asked, const Words& words) const {
    const EditedView asked_for = scene_edits(*imported_, words.edits), built = scene_edits(*imported_, {});
    if (asked_for.instances != built.instances || asked_for.maps != built.maps)
        throw Error(
            Exit::usage,
            "settings `hide`, `instance.N...` and textures of materials: the scene is built, so they stay where they are");
    EditedView edited;
    const float aspect = float(words.settings.whole_width()) / float(words.settings.whole_height());
    edited.view = make_view(*imported_, aspect, text_of(asked.camera), text_of(asked.light));
    apply_scene_edits(*imported_, edited);
    for (const Word& word : words.edits) apply_edit(*imported_, edited, word.key, word.value);
    if (edited.follows_path && !edited.camera_path.empty())
        edited.view.camera = edited.camera_path.at(edited.camera_path.keys.front().time_s);
    return visible_view(edited);
}

void clarity_tracer::trace_samples(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings,
                                   const View& view, Progress& progress) {
    constexpr double kSamplesMs = 100;
    const auto all = static_cast<unsigned>(settings.spp);
    double wall_ms = 0;
    RayCounts counts;
    for (unsigned done = 0, next = std::min(all, 2u); done < all;) {
        if (!progress.report(float(done) / float(all))) throw Cancelled();
        PartOf part(progress, double(done) / all, double(next) / all);
        const FrameStats stats = frames_->trace(prepared, settings, view, done, true, part, next);
        wall_ms += stats.wall_ms;
        counts += stats;
        done += next;
        next =
            std::min(static_cast<unsigned>(std::clamp(kSamplesMs / std::max(wall_ms / done, 1e-3), 1.0, 1024.0)), all - done);
    }
    if (counts.not_finite > 0) log(LogLevel::error, not_finite_text(counts.not_finite));
    if (counts.dropped > 0)
        log(LogLevel::warning, dropped_text(counts.dropped, settings.tracer == "path" ? 0 : settings.ray_slots));
}

void clarity_tracer::render(const clarity_picture& asked, clarity_picture& picture, Progress& progress) {
    Words words{settings_, {}};
    read_words(asked.settings, words);
    Settings& settings = words.settings;
    check_used(asked.settings, settings);
    const char* const of_tracer[] = {"denoise=on", nullptr};
    if (settings_.denoise == "on" && settings.tracer == settings_.tracer && settings.aov == settings_.aov)
        check_used(of_tracer, settings);
    const unsigned channels = find_aov(settings.aov).value_channels();
    const uint64_t floats = uint64_t(settings.width) * uint64_t(settings.height) * channels;
    const std::lock_guard<std::mutex> lock(keeping_->calls);
    const View view = view_of(asked, words);
    if (asked.pixels) {
        if (asked.room < floats)
            throw Error(Exit::usage, "the picture has " + std::to_string(floats) + " floats, and there is room for " +
                                         std::to_string(asked.room) + ": call with pixels = NULL to learn the size");
        settings.optics = optics_of(*placed_, view, settings);
        MovedStructure here;
        here.accel = prepared_->accel;
        here.on_devices = {{device_, prepared_->on_device}};
        const auto prepared = preparer_.prepare(placed_, settings, progress, here);
        progress.stage("rendering");
        if (!frames_) frames_.emplace(Devices{device_});
        trace_samples(prepared, settings, view, progress);
        const FloatImage image = frames_->read_picture(settings);
        std::copy(image.pixels.begin(), image.pixels.end(), asked.pixels);
    }
    picture.channels = channels;
    picture.width = static_cast<uint32_t>(settings.width);
    picture.height = static_cast<uint32_t>(settings.height);
}
