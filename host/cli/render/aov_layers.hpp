// aov_layers.hpp -- --aov all: the colours and everything about the first hit, as layers of one file.
#pragma once
#include <vector>

#include "cli/commands.hpp"
#include "render/multi/multi_frame_renderer.hpp"

namespace clarity {

// Takes `--aov all` out of the options and notes it in all_aovs; the settings know single quantities only.
RenderOptions with_all_aovs(const RenderOptions& options);

// Traces every quantity of the first hit, at the centres of the pixels, in the order of aov_table(). Those of cost are left
// out: they describe the tracer and not the picture. The film of `frames` is lost. Throws what MultiPreparer::prepare() and
// MultiFrameRenderer::trace() throw.
std::vector<PictureLayer> trace_aov_layers(MultiFrameRenderer& frames, MultiPreparer& preparer,
                                           const std::shared_ptr<const Scene>& scene, const View& view, Settings settings,
                                           Progress& progress);

}  // namespace clarity
