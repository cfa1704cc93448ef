// multi_frame_renderer.hpp -- pictures that several devices share.
//
// With one device this is just a FrameRenderer. Several devices trace tiles (tile_scheduler.hpp), each into a film of its own
// and from a host thread of its own, and copy their rows into one picture in host memory. One device traces a pixel in all
// samples. So devices of the same kind produce the picture that one of them would produce, bit for bit. Where the others save
// no time, the fastest traces alone (TeamChoice). If a device fails, a warning is logged and the other devices trace its
// tiles again.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "base/error.hpp"
#include "base/pictures/image_io.hpp"
#include "picture/frame_stats.hpp"
#include "rt_types.h"
#include "stand/multi_preparer.hpp"
#include "stand/ranks.hpp"

namespace clarity {

class AsyncReadback;
struct FalseColorScale;
struct FilmNoise;
struct View;

// A device failed while a picture with motion blur was traced. Its samples are of poses that are gone, so no other device can
// trace them again: the picture must be begun anew, with sample 0. The other devices go on.
class SamplesLost : public Error {
 public:
    SamplesLost()
        : Error(Exit::failed,
                "a device failed in the middle of a picture with motion blur, so that its part of the picture is "
                "lost: render the picture again") {}
};

// Has the functions of FrameRenderer, for one device or several. Used from one thread.
class MultiFrameRenderer {
 public:
    // A device that cannot hold a film causes a warning, as long as another can. Throws what FrameRenderer's constructor
    // throws.
    // ranks: other processes that trace parts of the picture. Rank 0 reads the whole picture, while the others call the same
    // functions and get their part. Must outlive this object.
    explicit MultiFrameRenderer(const Devices& devices, Ranks* ranks = nullptr);
    ~MultiFrameRenderer();

    // Traces samples [sample, sample + samples) of the picture; sample 0 starts a new picture. See FrameRenderer::trace(). The
    // returned figures are sums over these samples. Many samples in one call, from sample 0 on, are faster than one by one:
    // devices wait for each other once, at the end, and GPUs trace many samples in one launch. Throws SamplesLost if a device
    // fails in a picture with motion blur.
    FrameStats trace(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings, const View& view,
                     unsigned sample, bool count_rays, Progress& progress, unsigned samples = 1,
                     const std::function<void()>& meanwhile = {});
    // The number of complete samples, also after a trace() that was cancelled.
    unsigned samples() const;

    // For checkpoints, of colours only. read_sums(): the film itself, 4 channels: sums of r, g and b, and the number of
    // samples. Call it between two trace(), because a cancelled one leaves a film in which some pixels have a sample more.
    // resume(): puts such sums back. The next trace(), with these arguments and `samples` as its first sample, goes on with the
    // bits that the picture would have had; also on other devices, which then share the picture anew.
    unsigned planes() const;  // of the film: FrameRenderer::read_sums()
    bool has_guides() const;  // the film has what the denoiser needs
    FloatImage read_sums();
    void resume(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings,
                std::shared_ptr<const FloatImage> sums, unsigned samples);

    // Of a film that has two planes or more.
    FilmNoise noise();
    // Adaptive sampling: looks at the film after `samples` samples, which is_look() has to accept, and lets pixels rest.
    // Returns how many have too large an error. trace() does it by itself; whoever asks before makes it no second time.
    uint64_t look(const Settings& settings, unsigned samples);

    // As in FrameRenderer. What is denoised is whole on one device; of several ranks the first one has it.
    FloatImage read_values();
    FloatImage read_picture(const Settings& settings);
    FloatImage read_distance();
    ByteImage read_display(const Settings& settings, FrameStats* stats = nullptr, FalseColorScale* scale = nullptr);
    // Only if overlaps_copies(). Several devices do not support this: they copy before they continue.
    AsyncReadback begin_display(const Settings& settings);
    bool overlaps_copies() const;

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// The constants of a frame, for others who trace it: they have no structure of ours, and thus no root and no planes.
rt_frame frame_constants(const View& view, const Settings& settings);

}  // namespace clarity
