#include "bench/cases/moving.hpp"

#include <chrono>
#include <cmath>
#include <cstring>

#include "base/elapsed.hpp"
#include "base/error.hpp"

namespace clarity::bench {
namespace {

constexpr unsigned kPictures = 100;
constexpr float kStep = 0.004f;  // radians between two pictures

View turned(View view, unsigned step) {
    const float angle = kStep * float(step), c = std::cos(angle), s = std::sin(angle);
    Camera& camera = view.camera;
    const float x = camera.eye[0] - camera.target[0], z = camera.eye[2] - camera.target[2];
    camera.eye[0] = camera.target[0] + c * x + s * z;
    camera.eye[2] = camera.target[2] - s * x + c * z;
    return view;
}

// A digest of all bytes of a picture, which costs little compared with tracing it.
void add_bytes(uint64_t& digest, const SharedBytes& bytes) {
    for (size_t i = 0; i + 8 <= bytes.size(); i += 8) {
        uint64_t word;
        std::memcpy(&word, bytes.data() + i, sizeof word);
        digest = (digest ^ word) * 0x9E3779B97F4A7C15u;
    }
}

}  // namespace

Sample show_moving(FrameRenderer& frames, const Prepared& prepared, const Settings& settings, const View& view, bool overlapped,
                   Progress& progress, std::vector<KernelTime>* parts, uint64_t* digest) {
    Sample sample;
    AsyncReadback pending;
    FrameStats pending_stats;
    const auto show = [&](const ByteImage& picture, const FrameStats& stats) {
        if (parts) parts->insert(parts->end(), stats.kernels.begin(), stats.kernels.end());
        if (digest) add_bytes(*digest, picture.pixels);
    };
    const auto show_pending = [&] {
        if (pending) show(pending.wait(&pending_stats.kernels), pending_stats);
    };
    const auto begin = std::chrono::steady_clock::now();
    for (unsigned i = 0; i < kPictures; ++i) {
        if (progress.cancelled()) throw Cancelled();
        FrameStats stats = frames.trace(prepared, settings, turned(view, i), 0, false, progress, nullptr, show_pending);
        sample.time_ms += stats.device_ms / kPictures;
        if (overlapped) {
            pending = frames.begin_display(settings);
            pending_stats = std::move(stats);
        } else {
            show(frames.read_display(settings, &stats), stats);
        }
    }
    show_pending();
    sample.wall_ms = ms_since(begin) / kPictures;
    return sample;
}

}  // namespace clarity::bench
