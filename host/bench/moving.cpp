#include "bench/moving.hpp"

#include <chrono>
#include <cmath>
#include <cstring>

#include "base/elapsed.hpp"
#include "base/error.hpp"

namespace clarity {
namespace {

constexpr unsigned kPictures = 100;
constexpr float kStep = 0.004f;  // of a circle's 6.28

View turned(View view, unsigned step) {
    const float angle = kStep * float(step), c = std::cos(angle), s = std::sin(angle);
    Camera& camera = view.camera;
    const float x = camera.eye[0] - camera.target[0], z = camera.eye[2] - camera.target[2];
    camera.eye[0] = camera.target[0] + c * x + s * z;
    camera.eye[2] = camera.target[2] - s * x + c * z;
    return view;
}

// Wants the whole picture, and costs little beside it.
void add_bytes(uint64_t& digest, const uint8_t* bytes, size_t count) {
    for (size_t i = 0; i + 8 <= count; i += 8) {
        uint64_t word;
        std::memcpy(&word, bytes + i, sizeof word);
        digest = (digest ^ word) * 0x9E3779B97F4A7C15u;
    }
}

}  // namespace

Take show_moving(Frames& frames, const Prepared& prepared, const Settings& settings, const View& view, bool overlapped,
                 Progress& progress, std::vector<KernelTime>* parts, uint64_t* digest) {
    const size_t bytes = size_t(settings.width) * size_t(settings.height) * 4;
    Take take;
    const auto begin = std::chrono::steady_clock::now();
    for (unsigned i = 0; i < kPictures; ++i) {
        if (progress.cancelled()) throw Cancelled();
        FrameStats stats = frames.trace(prepared, settings, turned(view, i), 0, false, progress);
        take.time_ms += stats.device_ms / kPictures;
        const uint8_t* picture =
            overlapped ? frames.exchange_display(settings, &stats) : frames.look_at_display(settings, &stats);
        if (parts) parts->insert(parts->end(), stats.kernels.begin(), stats.kernels.end());
        if (picture && digest) add_bytes(*digest, picture, bytes);
    }
    if (overlapped) {
        const uint8_t* picture = frames.last_display();
        if (digest) add_bytes(*digest, picture, bytes);
    }
    take.wall_ms = ms_since(begin) / kPictures;
    return take;
}

}  // namespace clarity
