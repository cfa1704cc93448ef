// overlay.hpp -- bounding volumes to be drawn over the pictures: which level, and what there is of it.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>

#include "render/accel/accel_build.hpp"
#include "ui/overlay/line_list.hpp"
#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

// The volumes of each side's structure, fetched on a thread of their own: a large tree takes a while to walk.
class VolumeOverlay {
 public:
    explicit VolumeOverlay(std::function<void()> wake) : wake_(std::move(wake)) {}

    // As the keys do: the level that is shown already is hidden.
    void toggle(rt_u32 level);
    void show(std::optional<rt_u32> level) { level_ = level; }
    std::optional<rt_u32> level() const { return level_; }
    // Whether parts behind the picture's surfaces are left out; else they are faint.
    bool hides_behind() const { return hides_behind_; }
    void hide_behind(bool hidden) { hides_behind_ = hidden; }
    bool ready() const { return !sides_[0].fetching.valid() && !sides_[1].fetching.valid(); }
    // Volumes drawn of a side, and whether there are more than are drawn.
    size_t count(unsigned side = 0) const;
    bool more(unsigned side = 0) const { return sides_[side].volumes && sides_[side].volumes->more; }
    static constexpr size_t kLimit = 20000;

    // Fetches what is missing; once a frame. other: of the side that is compared with, or nullptr.
    void update(const std::shared_ptr<const AccelData>& main, const std::shared_ptr<const AccelData>& other = nullptr);
    // Changes whenever the lines of a side would.
    uint64_t revision(unsigned side) const { return sides_[side].revision; }
    // Appends every stride-th of a side's volumes as lines; `eye` sees spheres' outlines.
    void append_lines(unsigned side, const glm::vec3& eye, float scale, unsigned stride, LineList& lines) const;
    bool has_spheres(unsigned side) const { return sides_[side].volumes && !sides_[side].volumes->spheres.empty(); }

 private:
    struct Level : Volumes {
        bool more = false;
    };
    using Result = std::shared_ptr<const Level>;
    struct Side {
        // What `volumes` and `fetching` are of.
        std::shared_ptr<const AccelData> accel;
        std::optional<rt_u32> fetched;
        Result volumes;
        std::future<Result> fetching;
        uint64_t revision = 0;
    };
    void update_side(Side& side, const std::shared_ptr<const AccelData>& accel);

    std::function<void()> wake_;
    std::optional<rt_u32> level_;
    bool hides_behind_ = false;
    std::array<Side, 2> sides_;
};

// "level 4", "bottom level": as the keys count.
std::string level_name(rt_u32 level);
// The colour of a level's volumes, opaque.
uint32_t level_color(rt_u32 level);

}  // namespace clarity::ui
