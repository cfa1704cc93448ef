// overlay.hpp -- the bounding volumes to draw over the pictures: which level, and its boxes and spheres.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>

#include "stand/levels.hpp"
#include "ui/overlay/line_list.hpp"
#include "ui/widgets/rect.hpp"

namespace clarity::ui {

// A structure, and its buffers if a device has moved it since its build.
struct ShownStructure {
    std::shared_ptr<const AccelData> accel;
    std::weak_ptr<const DeviceScene> moved;
    bool is_moved = false;
};

// The volumes of each side's structure. They are fetched on a separate thread, because to walk a large tree takes a while.
class VolumeOverlay {
 public:
    explicit VolumeOverlay(std::function<void()> wake) : wake_(std::move(wake)) {}

    // Shows a level, or hides it if it is shown already. The keys do this.
    void toggle(rt_u32 level);
    void show(std::optional<rt_u32> level) { level_ = level; }
    std::optional<rt_u32> level() const { return level_; }
    // Whether parts behind the picture's surfaces are omitted; otherwise they are faint.
    bool hides_behind() const { return hides_behind_; }
    void hide_behind(bool hidden) { hides_behind_ = hidden; }
    bool ready() const { return !sides_[0].fetching.valid() && !sides_[1].fetching.valid(); }
    // The number of volumes drawn for a side, and whether the level has more than that.
    size_t count(unsigned side = 0) const;
    bool more(unsigned side = 0) const { return sides_[side].volumes && sides_[side].volumes->more; }
    static constexpr size_t kLimit = 20000;

    // Fetches missing volumes; call once a frame. other: structure of the compared side, if there is one.
    void update(const ShownStructure& main, const ShownStructure& other = {});
    // A number which changes whenever the lines of a side do.
    uint64_t revision(unsigned side) const { return sides_[side].revision; }
    // Appends every stride-th volume of a side as lines. eye: where the outlines of spheres are seen from.
    void append_lines(unsigned side, const glm::vec3& eye, float scale, unsigned stride, LineList& lines) const;
    bool has_spheres(unsigned side) const { return sides_[side].volumes && !sides_[side].volumes->spheres.empty(); }

 private:
    struct Level : Volumes {
        bool more = false;
    };
    using Result = std::shared_ptr<const Level>;
    struct Side {
        // The structure and level of `volumes` and `fetching`.
        ShownStructure structure;
        std::optional<rt_u32> fetched;
        Result volumes;
        std::future<Result> fetching;
        uint64_t revision = 0;
    };
    void update_side(Side& side, const ShownStructure& structure);

    std::function<void()> wake_;
    std::optional<rt_u32> level_;
    bool hides_behind_ = false;
    std::array<Side, 2> sides_;
};

// "level 4" or "bottom level", counted as the keys do.
std::string level_name(rt_u32 level);
// The opaque colour of a level's volumes.
uint32_t level_color(rt_u32 level);

}  // namespace clarity::ui
