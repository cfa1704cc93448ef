#include "scene/instance_edit.hpp"

#include <algorithm>
#include <cmath>

#include "scene/motion/matrix.hpp"

namespace clarity {
namespace {

template <class List>
auto place_of(List& moved, rt_u32 instance) {
    return std::lower_bound(moved.begin(), moved.end(), instance,
                            [](const InstanceEdits::Moved& m, rt_u32 i) { return m.instance < i; });
}

}  // namespace

InstanceShift InstanceEdits::shift_of(rt_u32 instance) const {
    const auto at = place_of(moved, instance);
    return at != moved.end() && at->instance == instance ? at->shift : InstanceShift();
}

void InstanceEdits::set_shift(rt_u32 instance, const InstanceShift& shift) {
    const auto at = place_of(moved, instance);
    const bool is = at != moved.end() && at->instance == instance, does_nothing = shift == InstanceShift();
    if (is && does_nothing)
        moved.erase(at);
    else if (is)
        at->shift = shift;
    else if (!does_nothing)
        moved.insert(at, {instance, shift});
}

bool InstanceEdits::is_hidden(rt_u32 instance) const {
    return std::binary_search(hidden.begin(), hidden.end(), instance);
}

void InstanceEdits::hide(rt_u32 instance, bool hide) {
    const auto at = std::lower_bound(hidden.begin(), hidden.end(), instance);
    const bool is = at != hidden.end() && *at == instance;
    if (hide && !is) hidden.insert(at, instance);
    if (!hide && is) hidden.erase(at);
}

rt_u32 InstanceEdits::mask_of(rt_u32 instance) const {
    const auto found = masks.find(instance);
    return found == masks.end() ? RT_SEEN_BY_ALL : found->second;
}

void InstanceEdits::set_mask(rt_u32 instance, rt_u32 mask) {
    masks.erase(instance);
    if (mask != RT_SEEN_BY_ALL) masks[instance] = mask;
}

const std::array<float, 3>& MeshMiddles::of(const Scene& scene, rt_u32 mesh) {
    const auto [at, is_new] = known_.emplace(mesh, std::array<float, 3>{});
    if (is_new) {
        const Mesh& range = scene.meshes[mesh];
        Bounds box;
        for (size_t i = 0; i < 3 * size_t(range.triangle_count); ++i)
            box.add(&scene.positions[3 * size_t(scene.triangles[3 * size_t(range.first_triangle) + i])]);
        for (int k = 0; k < 3 && !box.empty; ++k) at->second[k] = 0.5f * (box.min[k] + box.max[k]);
    }
    return at->second;
}

Affine shifted(const InstanceShift& shift, const std::array<float, 3>& pivot, const Affine& world_from_object) {
    Affine result = world_from_object;
    if (shift.degrees != InstanceShift().degrees || shift.scale != InstanceShift().scale) {
        const Vec middle = to_vec(transform_point(world_from_object, pivot.data()));
        Matrix from_middle = kIdentityMatrix, to_middle = kIdentityMatrix;
        for (int k = 0; k < 3; ++k) {
            from_middle[4 * k + 3] = -middle[k];
            to_middle[4 * k + 3] = middle[k];
        }
        const Matrix turn = rotation(from_angles(to_vec(shift.degrees), RT_ROTATE_XYZ));
        result = to_affine(to_middle * turn * scaling(to_vec(shift.scale)) * from_middle * to_matrix(world_from_object));
    }
    for (int k = 0; k < 3; ++k) result[4 * k + 3] += shift.translate[k];
    return result;
}

Scene with_edits(const Scene& rest, const InstanceEdits& edits, const std::vector<rt_u32>& apart, MeshMiddles& middles) {
    Scene scene = rest;
    for (const rt_u32 i : apart)
        if (i < scene.instances.size()) scene.instances[i].apart = true;
    for (const InstanceEdits::Moved& moved : edits.moved) {
        if (moved.instance >= scene.instances.size()) continue;
        Instance& instance = scene.instances[moved.instance];
        instance.apart = true;
        instance.shift = moved.shift;
        instance.pivot = middles.of(scene, instance.node == RT_NONE ? instance.mesh : instance.moving_mesh);
        instance.world_from_object = shifted(instance.shift, instance.pivot, instance.world_from_object);
    }
    for (const rt_u32 i : edits.hidden)
        if (i < scene.instances.size()) {
            scene.instances[i].hidden = true;
            scene.instances[i].visible = false;
        }
    for (const auto& [i, mask] : edits.masks)
        if (i < scene.instances.size()) scene.instances[i].mask = mask;
    return scene;
}

Scene with_edits(const Scene& rest, const InstanceEdits& edits) {
    MeshMiddles middles;
    return with_edits(rest, edits, {}, middles);
}

}  // namespace clarity
