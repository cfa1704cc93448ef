// light_kinds.hpp -- the table of the kinds of lights: their keys, and all that differs between them. A new kind is a number in
// rt_shared.h, a row here, and kernels that light with it. RT_EMITTER_SURFACE in rt_types.h must stay above all kinds.
#pragma once
#include "base/problem.hpp"
#include "scene/key.hpp"
#include "scene/motion/matrix.hpp"
#include "scene/scene.hpp"

namespace clarity {

struct LightKind {
    rt_u32 kind = 0;         // RT_LIGHT_POINT, ...
    const char* name = "";   // in text
    const char* label = "";  // in the panel
    const char* help = "";
    // Whether it is somewhere in the world: its handle can be dragged. Otherwise it lies in a direction.
    bool has_place = true;
    bool has_size = false;  // Whitted's tracers show it as a point at its middle
    // The power by which `path` picks it, for a colour of 1, in a scene of that radius: that of a light far away is what falls
    // on the scene.
    double (*power)(const rt_light& light, double radius) = nullptr;
    std::vector<Key> keys;
    void (*complete)(rt_light&) = nullptr;  // computes the members that no key holds; or nullptr
};

const std::vector<LightKind>& light_kinds();  // in the order of RT_LIGHT_POINT, ...
const LightKind& light_kind_of(const rt_light& light);
const LightKind* find_light_kind(const std::string& name);

rt_light default_light(rt_u32 kind);                           // all keys at their defaults
const rt_primitive_kind* light_kind_for_plugins(rt_u32 kind);  // NULL: there is no such kind
// What an importer delivers, in its own coordinates. Sets `problem` as material_of() does. Returns false if it cannot be used:
// numbers that are not finite, vectors of no length.
bool light_of(const rt_light_desc& desc, rt_light& light, std::string& problem);
// To be called after any change. Makes directions unit vectors, colours 0 or more, and computes the members that no key holds;
// the light no longer stands in for another. Returns false if a member cannot be used. keep_units: a vector of length 1, but
// for rounding, stays as it is.
bool make_sound(rt_light& light, bool keep_units = false);
// Moves the light as its keys say, and makes it sound.
bool move_light(rt_light& light, const Matrix& world_from_local);
// The value of a key as edits have it: see Key::reversed_in_edits.
std::array<float, 3> edit_value(const Key& key, const rt_light& light);
void set_edit_value(const Key& key, rt_light& light, std::array<float, 3> value);
// "`angle` is 200, expected from 0 to 180", or nothing.
Problem light_fault(const rt_light& light);

}  // namespace clarity
