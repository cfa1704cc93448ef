// picture_tracer.hpp -- traces the samples of one picture in batches.
#pragma once
#include <functional>
#include <memory>

#include "base/progress.hpp"
#include "cli/render/frame_scene.hpp"
#include "cli/render/render_stats.hpp"
#include "stand/multi_frame_renderer.hpp"

namespace clarity {

// Used from one thread. The references must outlive it.
class PictureTracer {
 public:
    // What is traced; blur is null if all samples are at one time.
    struct Picture {
        std::shared_ptr<const MultiPrepared> prepared;
        const FrameScene& scene;
        MotionBlur* blur;
    };
    struct Pass {
        unsigned first = 0;                                  // sample; those before it are in the film
        bool counts = true, timed = true;                    // whether the statistics get its rays, and its times
        double from = 0, share = 1;                          // of the progress
        bool at_most_doubles = false;                        // whether `between` is called at each doubling of the samples
        std::function<void(unsigned samples)> between = {};  // if set, called after each batch, when the film is exact
        // If set, called likewise: how many samples may follow at most before it is asked again; 0: the picture is complete.
        std::function<unsigned(unsigned samples)> more = {};
    };
    struct Traced {
        unsigned samples = 0;  // complete ones in the film
        bool exact = true;     // no pixel of the film has more of them
        bool whole = false;    // they are all, or enough
    };
    // ranks: other processes that trace parts of the picture; nullptr: none.
    PictureTracer(MultiFrameRenderer& frames, const Settings& settings, RenderStats& stats, Ranks* ranks)
        : frames_(frames), settings_(settings), stats_(stats), ranks_(ranks) {}

    // Traces the samples of a picture from pass.first on, until all are there or `progress` cancels. Adds to the statistics.
    // Throws what MultiFrameRenderer::trace() throws, but not Cancelled.
    Traced trace(const Picture& picture, const Pass& pass, Progress& progress);

 private:
    FrameStats trace_samples(const Picture& picture, unsigned first, unsigned how_many, bool count, Progress& progress);
    static unsigned batch(double wall_ms, unsigned done, unsigned left);

    MultiFrameRenderer& frames_;
    const Settings& settings_;
    RenderStats& stats_;
    Ranks* const ranks_;
};

}  // namespace clarity
