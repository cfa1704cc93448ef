#include "ui/session/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/angle.hpp"
#include "base/error.hpp"
#include "base/files/frame_path.hpp"
#include "base/pictures/image_io.hpp"
#include "ui/session/camera_control.hpp"
#include "ui/session/session.hpp"

namespace clarity::ui {
namespace {

// Catmull-Rom spline from b (u = 0) to c (u = 1).
template <size_t N>
std::array<float, N> between(const std::array<float, N>& a, const std::array<float, N>& b, const std::array<float, N>& c,
                             const std::array<float, N>& d, float u) {
    std::array<float, N> out;
    for (size_t k = 0; k < N; ++k)
        out[k] =
            0.5f * (2 * b[k] +
                    u * (c[k] - a[k] + u * (2 * a[k] - 5 * b[k] + 4 * c[k] - d[k] + u * (3 * b[k] - 3 * c[k] + d[k] - a[k]))));
    return out;
}

}  // namespace

void Sequence::start_turntable(Session& session, const std::string& pattern, int frames) {
    if (frames < 1 || frames > 9999) throw Error(Exit::usage, "a turntable has 1 to 9999 frames");
    const Camera from = running() ? before_ : session.desired.camera;
    std::vector<Camera> cameras;
    for (int i = 0; i < frames; ++i) {
        cameras.push_back(from);
        orbit_camera(cameras.back(), static_cast<float>(kTurn) * static_cast<float>(i) / static_cast<float>(frames), 0);
    }
    start(session, pattern, std::move(cameras));
}

void Sequence::start_path(Session& session, const std::string& pattern, int frames, const std::vector<Camera>& through) {
    if (through.size() < 2) throw Error(Exit::usage, "a path needs at least two bookmarks");
    if (frames < 2 || frames > 9999) throw Error(Exit::usage, "a path has 2 to 9999 frames");
    const auto at = [&](long i) -> const Camera& {
        return through[static_cast<size_t>(std::clamp<long>(i, 0, static_cast<long>(through.size()) - 1))];
    };
    std::vector<Camera> cameras;
    for (int i = 0; i < frames; ++i) {
        const float along = static_cast<float>(i) * static_cast<float>(through.size() - 1) / static_cast<float>(frames - 1);
        const long k = std::min(static_cast<long>(along), static_cast<long>(through.size()) - 2);
        const float u = along - static_cast<float>(k);
        Camera camera = at(k);
        camera.eye = between(at(k - 1).eye, at(k).eye, at(k + 1).eye, at(k + 2).eye, u);
        camera.target = between(at(k - 1).target, at(k).target, at(k + 1).target, at(k + 2).target, u);
        camera.fov_y_rad = at(k).fov_y_rad + u * (at(k + 1).fov_y_rad - at(k).fov_y_rad);
        cameras.push_back(camera);
    }
    start(session, pattern, std::move(cameras));
}

void Sequence::start(Session& session, const std::string& pattern, std::vector<Camera> cameras) {
    if (!session.ready())
        throw Error(Exit::usage, "cannot start a sequence, because there is no picture yet; open a scene first");
    if (cameras.size() > 1 && frame_path(pattern, 1) == frame_path(pattern, 2))
        throw Error(Exit::usage, pattern + ": put #### into its name, for the frame's number");
    check_output_path(frame_path(pattern, 1));
    drop_frame(session);
    if (!running()) before_ = session.desired.camera;
    pattern_ = pattern;
    cameras_ = std::move(cameras);
    next_ = 0;
}

// Cancels the save of the current frame if it still waits: its samples would be those of the next camera.
void Sequence::drop_frame(Session& session) {
    if (save_ != 0) session.cancel_save(save_);
    save_ = 0;
    camera_set_ = false;
}

void Sequence::stop(Session& session) {
    if (!running()) return;
    drop_frame(session);
    cameras_.clear();
    session.desired.camera = before_;
}

void Sequence::update(Session& session) {
    if (!running() || camera_set_) return;
    if (next_ == count()) return stop(session);
    session.desired.camera = cameras_[static_cast<size_t>(next_)];
    camera_set_ = true;
}

void Sequence::posted(Session& session) {
    if (camera_set_ && save_ == 0) save_ = session.save_picture(frame_path(pattern_, next_ + 1));
}

void Sequence::saved(Session& session, uint64_t number, bool worked) {
    if (save_ == 0 || number != save_) return;
    save_ = 0;
    camera_set_ = false;
    ++next_;
    if (!worked) stop(session);
}

std::string next_picture_path(const std::string& folder) {
    const std::filesystem::path base = folder.empty() ? "." : folder;
    for (int number = 1; number < 10000; ++number) {
        const std::string path = (base / frame_path("clarity_####.png", number)).string();
        if (!std::filesystem::exists(path)) return path;
    }
    throw Error(Exit::failed, base.string() + ": holds 9999 saved pictures already; choose another folder");
}

}  // namespace clarity::ui
