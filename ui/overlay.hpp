// overlay.hpp -- bounding volumes drawn over the picture as lines.
#pragma once
#include <future>
#include <memory>
#include <optional>

#include "render/accel_build.hpp"
#include "render/renderer.hpp"
#include "ui/viewport.hpp"

struct ImDrawList;

namespace clarity {

// Which level is shown, and its volumes, fetched on a thread of their own: a large tree takes a while to walk.
class VolumeOverlay {
 public:
    explicit VolumeOverlay(std::function<void()> wake) : wake_(std::move(wake)) {}

    // As the keys do: the level that is shown already is hidden.
    void toggle(rt_u32 level);
    void show(std::optional<rt_u32> level) { level_ = level; }
    std::optional<rt_u32> level() const { return level_; }
    bool ready() const { return !fetching_.valid(); }
    // Volumes drawn last, and whether there are more than are drawn.
    size_t count() const { return volumes_ ? volumes_->boxes.size() + volumes_->spheres.size() : 0; }
    static constexpr size_t kLimit = 4096;

    // Fetches what is missing; once a frame.
    void update(const std::shared_ptr<const Prepared>& prepared);
    // Draws into `area` as the camera of the picture sees them.
    void draw(ImDrawList& list, const Rect& area, const Camera& camera) const;

 private:
    using Result = std::shared_ptr<const Volumes>;
    std::function<void()> wake_;
    std::optional<rt_u32> level_;
    // What `volumes_` and `fetching_` are of.
    std::shared_ptr<const AccelData> accel_;
    std::optional<rt_u32> fetched_;
    Result volumes_;
    std::future<Result> fetching_;
};

}  // namespace clarity
