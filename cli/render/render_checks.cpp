#include "cli/render/render_checks.hpp"

#include <charconv>
#include <string>

#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "base/files/output_file.hpp"
#include "base/pictures/image_io.hpp"
#include "cli/render/frame_record.hpp"
#include "cli/render/picture_checkpoint.hpp"
#include "cli/render/picture_goal.hpp"
#include "picture/film_noise.hpp"
#include "view/settings/aov.hpp"
#include "view/settings/settings.hpp"

namespace clarity {
namespace {

// Each repetition stores two times of 8 bytes, and there is one more pass to warm up: with this bound neither memory nor the
// pass counter comes near its limit.
constexpr unsigned kMaxRepeat = 1000000;

// The records lie beside the pictures, and must not replace another file of this run.
void check_records(const RenderOptions& options, const FrameRange& range) {
    if (options.frames.empty() && !options.skip_existing) return;
    for (const std::string* other : {&options.stats_file, &options.checkpoint, &options.resume})
        for (long frame = range.first; !other->empty() && frame <= range.last; frame += range.step)
            if (frame_path(*other, int(frame)) == record_path(frame_path(options.output, int(frame))))
                throw Error(Exit::usage,
                            "`" + frame_path(*other, int(frame)) +
                                "` is the record of a frame, which is written beside its picture; choose another name");
}

// Reads numbers and signs from left to right.
struct Reader {
    const char *at, *const end;
    explicit Reader(const std::string& text) : at(text.data()), end(at + text.size()) {}
    // Accepts digits only, because from_chars would accept a sign.
    bool number(int& value) {
        if (at == end || *at < '0' || *at > '9') return false;
        const auto [next, error] = std::from_chars(at, end, value);
        at = next;
        return error == std::errc();
    }
    bool sign(char c) { return at != end && *at == c ? (++at, true) : false; }
    bool done() const { return at == end; }
};

}  // namespace

FrameRange frames_of(const RenderOptions& options) {
    if (options.frames.empty()) return {};
    const FrameRange all = parse_frame_range(options.frames);
    return options.frames_of.empty() ? all : share_of_frames(all, options.frames_of);
}

void check_render_options(const RenderOptions& options, const Settings& settings, const FrameRange& range) {
    if (options.output.empty())
        throw Error(Exit::usage, "--output is required: `-o out.png` (`clarity render --help` explains)");
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
    if (options.repeat > 1 && has_goal(options))
        throw Error(
            Exit::usage,
            "--repeat times the same samples, and --error and --time-budget end a picture by itself; leave one of them out");
    if (options.error > 0 && (picture_of_tracer(settings.tracer) != kPathPicture || !find_aov(settings.aov).is_color()))
        throw Error(Exit::usage,
                    "--error: only colours of the tracer `path` have an estimated error; add --tracer path, or take --spp N");
    if (options.mpi && adaptive_bound(settings) > 0)
        throw Error(Exit::usage,
                    "--adaptive: looks at the whole picture, of which each rank of --mpi has a part; leave it out");
    check_pose(options.pose);
    if (options.skip_existing && options.watch)
        throw Error(Exit::usage, "--skip-existing leaves the pictures that --watch is to render again; leave one of them out");
    if (options.mpi && options.watch)
        throw Error(Exit::usage, "--mpi renders once, and --watch waits for changes; leave one of them out");
    if (options.all_aovs && !holds_layers(options.output))
        throw Error(Exit::usage, "--aov all: only an .exr holds several quantities; name one, or one quantity");
    if (!options.frames_of.empty() && options.frames.empty())
        throw Error(Exit::usage, "--frames-of " + options.frames_of + ": is a share of --frames, which is missing");
    check_checkpoint_options(options, settings, range.count());
    check_records(options, range);
    // The numbers of a camera can be checked without a scene, its name cannot.
    const bool named = !options.trace.camera.empty() && (options.trace.camera.find(',') == std::string::npos ||
                                                         options.trace.camera.find_first_of("0123456789+-.") != 0);
    make_view(Scene{}, 1, named ? std::string() : options.trace.camera, options.trace.light);
}

FrameRange parse_frame_range(const std::string& text) {
    Reader reader(text);
    FrameRange range;
    bool good = reader.number(range.first);
    range.last = range.first;
    if (good && reader.sign('-')) good = reader.number(range.last);
    int step = 1;
    if (good && reader.sign('/')) good = reader.number(step);
    range.step = step;
    if (!good || !reader.done())
        throw Error(Exit::usage, "--frames " + text + ": expected A-B or A-B/STEP, as in 1-24 or 1-24/2");
    if (range.last < range.first)
        throw Error(Exit::usage,
                    "--frames " + text + ": the last frame comes before the first; write the smaller number first");
    if (range.step < 1) throw Error(Exit::usage, "--frames " + text + ": the step must be at least 1");
    return range;
}

FrameRange share_of_frames(const FrameRange& all, const std::string& text) {
    Reader reader(text);
    int which = 0, of = 0;
    if (!reader.number(which) || !reader.sign('/') || !reader.number(of) || !reader.done())
        throw Error(Exit::usage, "--frames-of " + text + ": expected K/N, as in 2/8 for the second of eight shares");
    if (which < 1 || of < 1 || which > of)
        throw Error(Exit::usage, "--frames-of " + text + ": K counts from 1 to N, the number of shares");
    const long first = all.first + (which - 1L) * all.step;
    if (first > all.last) return {1, 0, 1};
    return {static_cast<int>(first), all.last, of * all.step};
}

}  // namespace clarity
