#include "cli/render/picture_checkpoint.hpp"

#include <cstdio>
#include <filesystem>
#include <utility>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "stand/checkpoint.hpp"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

// Checkpoints go where the option says, else to the file that the picture goes on from.
const std::string& save_pattern(const RenderOptions& options) {
    return options.checkpoint.empty() ? options.resume : options.checkpoint;
}

}  // namespace

PictureCheckpoint::PictureCheckpoint(const RenderOptions& options, int frame, std::string digest, std::string way, unsigned of,
                                     Ranks* ranks)
    : resumed_(frame_path(options.resume, frame)),
      path_(frame_path(save_pattern(options), frame)),
      digest_(std::move(digest)),
      way_(std::move(way)),
      every_s_(options.every_s),
      of_(of),
      ranks_(ranks) {}

unsigned PictureCheckpoint::resume(MultiFrameRenderer& frames, const std::shared_ptr<const MultiPrepared>& prepared,
                                   const Settings& settings) {
    last_ = Clock::now();
    std::error_code error;
    if (resumed_.empty() || (resumed_ == path_ && !std::filesystem::exists(resumed_, error))) return 0;
    Checkpoint checkpoint = load_checkpoint(resumed_);
    if (checkpoint.picture != digest_)
        throw Error(Exit::failed,
                    resumed_ +
                        ": is a checkpoint of another picture: the scene, its time, the view, the settings, the kernels "
                        "or the program have changed; leave --resume out to begin the picture anew");
    const FloatImage& sums = *checkpoint.sums;
    if (int(sums.width) != settings.width || int(sums.height / checkpoint.planes) != settings.height ||
        checkpoint.planes != prepared->planes() || checkpoint.samples == 0 || checkpoint.samples >= of_)
        throw Error(Exit::failed, resumed_ + ": holds " + plural(checkpoint.samples, "sample") + " of " +
                                      std::to_string(sums.width) + "x" + std::to_string(sums.height) +
                                      " pixels, which do not fit this picture; leave --resume out to begin it anew");
    const bool tells = !ranks_ || ranks_->rank() == 0;
    if (tells && checkpoint.way != way_)
        log(LogLevel::warning, resumed_ + ": was traced with " + checkpoint.way + ", and the picture goes on with " + way_ +
                                   ": its last bits may differ from those of a picture that was traced in one go");
    frames.resume(prepared, settings, checkpoint.sums, checkpoint.samples);
    saved_ = resumed_ == path_ ? checkpoint.samples : 0;
    if (tells)
        log(LogLevel::info,
            resumed_ + ": goes on after " + std::to_string(checkpoint.samples) + " of " + std::to_string(of_) + " samples");
    return checkpoint.samples;
}

void PictureCheckpoint::offer(MultiFrameRenderer& frames, unsigned samples) {
    if (!saves()) return;
    const bool is_time = seconds_since(last_) >= every_s_;
    if (ranks_ ? ranks_->gather(is_time)[0] > 0 : is_time) save(frames, samples);
}

void PictureCheckpoint::save(MultiFrameRenderer& frames, unsigned samples) {
    Checkpoint checkpoint;
    checkpoint.picture = digest_;
    checkpoint.way = way_;
    checkpoint.samples = samples;
    checkpoint.of = of_;
    checkpoint.sums = std::make_shared<const FloatImage>(frames.read_sums());
    checkpoint.planes = frames.planes();
    if (!ranks_ || ranks_->rank() == 0) save_checkpoint(path_, checkpoint);
    saved_ = samples;
    last_ = Clock::now();
    log(LogLevel::debug, path_ + ": " + std::to_string(samples) + " of " + std::to_string(of_) + " samples");
}

void PictureCheckpoint::remove() {
    if (saves() && (!ranks_ || ranks_->rank() == 0)) std::remove(path_.c_str());
    saved_ = 0;
}

void check_checkpoint_options(const RenderOptions& options, const Settings& settings, long count) {
    const std::string& pattern = save_pattern(options);
    if (pattern.empty()) return;
    const auto refuse = [](const std::string& why) { throw Error(Exit::usage, why); };
    const std::string option = options.checkpoint.empty() ? "--resume" : "--checkpoint";
    for (const std::string* name : {&options.checkpoint, &options.resume})
        if (!name->empty() && count > 1 && frame_path(*name, 1) == frame_path(*name, 2))
            refuse((name == &options.resume ? "--resume " : "--checkpoint ") + *name +
                   " would be one file for several frames: put #### into its name, for the frame's number");
    if (options.repeat > 1)
        refuse(option + " saves a picture on its way, and --repeat traces it several times; leave one of them out");
    if (options.watch)
        refuse(option + " saves one picture on its way, and --watch renders others after it; leave one of them out");
    if (!find_aov(settings.aov).is_color())
        refuse(option + ": only colours are sums of samples; --aov " + settings.aov +
               " is rendered at once, without checkpoints");
    if (frame_path(pattern, 1) == frame_path(options.output, 1)) refuse(option + " and --output name the same file");
    check_writable(frame_path(pattern, 1));
}

}  // namespace clarity
