// multi_frame_renderer.hpp -- pictures that several devices share.
//
// As Frames, and with one device nothing but that. Several trace strips of rows (tile_scheduler.hpp), each into a film of its
// own, from a host thread of its own, and bring what is theirs into one picture of the host. A pixel is one device's for all
// samples, so devices of one kind make the picture that one of them makes, bit for bit. One that fails is out, with a warning:
// the others trace its strips again.
#pragma once
#include <memory>
#include <vector>

#include "render/multi/multi_preparer.hpp"

namespace clarity {

// Used from one thread.
class MultiFrameRenderer {
 public:
    // A device that cannot hold a film is a warning, as long as another can. Throws what Frames throws.
    explicit MultiFrameRenderer(const Devices& devices);
    ~MultiFrameRenderer();

    // Samples [sample, sample + samples) of the picture; the first anew if it is 0. See Frames::trace(); figures are sums over
    // these samples. Devices wait for each other once, at the end, and GPUs trace many samples in one launch, so that many at a
    // time, from the first on, are faster than one by one.
    FrameStats trace(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings, const View& view,
                     unsigned sample, bool count_rays, Progress& progress, unsigned samples = 1,
                     const std::function<void()>& meanwhile = {});
    // That are complete, also after a trace() that was cancelled.
    unsigned samples() const;

    // As Frames has them.
    FloatImage read_values();
    FloatImage read_distance();
    ByteImage read_display(const Settings& settings, FrameStats* stats = nullptr, FalseColorScale* scale = nullptr);
    // Where copies_aside(), which several devices do not: they copy before they go on.
    AsyncReadback begin_display(const Settings& settings);
    bool copies_aside() const;

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace clarity
