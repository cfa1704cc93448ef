// picture_checkpoint.hpp -- --checkpoint, --every and --resume of one picture.
#pragma once
#include <chrono>
#include <memory>
#include <string>

#include "cli/commands.hpp"
#include "stand/multi_frame_renderer.hpp"

namespace clarity {

// Used from one thread.
class PictureCheckpoint {
 public:
    // frame: the number for # in the names. digest, way: as in Checkpoint. of: samples of the whole picture. ranks: processes
    // that share the picture, of which the first saves it; all call the same functions. nullptr: none.
    PictureCheckpoint(const RenderOptions& options, int frame, std::string digest, std::string way, unsigned of,
                      Ranks* ranks = nullptr);

    bool saves() const { return !path_.empty(); }
    const std::string& path() const { return path_; }
    // Puts the samples of the file of --resume back. Returns their number; 0: the picture begins anew, because the file is also
    // that of --checkpoint and does not exist yet. Throws Error(failed) if there is no checkpoint of this picture.
    unsigned resume(MultiFrameRenderer& frames, const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings);
    // Saves the film if the last time was --every seconds ago. `samples` are complete, and no pixel has more. Throws
    // Error(failed).
    void offer(MultiFrameRenderer& frames, unsigned samples);
    void save(MultiFrameRenderer& frames, unsigned samples);
    // Of the checkpoint on disk: what was saved or resumed last; 0: none.
    unsigned saved() const { return saved_; }
    // The picture is complete.
    void remove();

 private:
    using Clock = std::chrono::steady_clock;
    const std::string resumed_, path_, digest_, way_;
    const double every_s_;
    const unsigned of_;
    Ranks* const ranks_;
    unsigned saved_ = 0;
    Clock::time_point last_ = Clock::now();
};

// Throws Error(usage) for options that do not go together. count: number of frames.
void check_checkpoint_options(const RenderOptions& options, const Settings& settings, long count);

}  // namespace clarity
