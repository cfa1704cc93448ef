// instance_edit.hpp -- instances that a user moves, turns, scales and hides, and masks of rays, on top of where files and poses
// have them.
#pragma once
#include <map>
#include <vector>

#include "scene/scene.hpp"

namespace clarity {

// All that a user has done to the instances of a scene.
struct InstanceEdits {
    struct Moved {
        rt_u32 instance = 0;
        InstanceShift shift;
        bool operator==(const Moved& b) const { return instance == b.instance && shift == b.shift; }
    };
    std::vector<Moved> moved;          // ascending; each shifts its instance
    std::vector<rt_u32> hidden;        // ascending
    std::map<rt_u32, rt_u32> masks{};  // kinds of rays that hit an instance: RT_SEEN_BY_*; of those that not all do

    bool empty() const { return moved.empty() && hidden.empty() && masks.empty(); }
    bool operator==(const InstanceEdits& b) const { return moved == b.moved && hidden == b.hidden && masks == b.masks; }
    bool operator!=(const InstanceEdits& b) const { return !(*this == b); }
    InstanceShift shift_of(rt_u32 instance) const;
    // A shift that does nothing is none.
    void set_shift(rt_u32 instance, const InstanceShift& shift);
    bool is_hidden(rt_u32 instance) const;
    void hide(rt_u32 instance, bool hidden);
    rt_u32 mask_of(rt_u32 instance) const;
    void set_mask(rt_u32 instance, rt_u32 mask);
};

// The middles of meshes, found once each: in O(its vertices).
class MeshMiddles {
 public:
    // In the mesh's own space: of the box of its triangles.
    const std::array<float, 3>& of(const Scene& scene, rt_u32 mesh);

 private:
    std::map<rt_u32, std::array<float, 3>> known_;
};

// The transform of an instance that its file or pose puts at `world_from_object`.
Affine shifted(const InstanceShift& shift, const std::array<float, 3>& pivot, const Affine& world_from_object);

// A scene at rest with these edits; poses of the result have them too. Shares all that is large with `rest`, which must have no
// edits. apart: instances to be kept apart besides those that are moved, because they will be. middles: of this scene.
Scene with_edits(const Scene& rest, const InstanceEdits& edits, const std::vector<rt_u32>& apart, MeshMiddles& middles);
Scene with_edits(const Scene& rest, const InstanceEdits& edits);

}  // namespace clarity
