// moving.hpp -- renders a sequence of pictures, as the window does while the camera moves.
#pragma once
#include "bench/run/measure.hpp"
#include "render/frame/frame_renderer.hpp"

namespace clarity::bench {

// Renders 100 pictures of a camera which circles its target. Each picture is copied to the host. Returns mean times per
// picture. overlapped: copies each picture while the next one is traced, else before. digest: receives a digest of all
// pictures' bytes. parts: receives the kernels' times of each picture.
Sample show_moving(FrameRenderer& frames, const Prepared& prepared, const Settings& settings, const View& view, bool overlapped,
                   Progress& progress, std::vector<KernelTime>* parts = nullptr, uint64_t* digest = nullptr);

}  // namespace clarity::bench
