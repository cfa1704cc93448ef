// moving.hpp -- picture after picture, as a window shows them while the camera moves.
#pragma once
#include "bench/run/measure.hpp"
#include "render/frame/renderer.hpp"

namespace clarity::bench {

// 100 pictures of a camera that goes about what it looks at, each on the host in the end; times are of one, in the mean.
// overlapped: each is copied while the next is traced, else before. digest: of all their bytes. parts: gain the times of each.
Sample show_moving(FrameRenderer& frames, const Prepared& prepared, const Settings& settings, const View& view, bool overlapped,
                   Progress& progress, std::vector<KernelTime>* parts = nullptr, uint64_t* digest = nullptr);

}  // namespace clarity::bench
