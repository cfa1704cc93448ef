#include "render/accel/guarded_build.hpp"

#include <algorithm>
#include <cstring>
#include <new>

#include "plugin/plugin_check.hpp"

namespace clarity {
namespace {

constexpr uint64_t kSlotLimit = uint64_t(1) << 40;

template <class T>
GuardedBytes read_only_copy(const T* data, uint64_t count, const char* name) {
    GuardedBytes copy(count * sizeof(T), name, sizeof(T) % 16 == 0 ? 16 : alignof(T));
    if (count > 0) std::memcpy(copy.data(), data, count * sizeof(T));
    copy.make_read_only();
    return copy;
}

GuardedOutput& output(void* ctx) {
    return *static_cast<GuardedOutput*>(ctx);
}

}  // namespace

BuilderInput::BuilderInput(const rt_prim* prim_array, uint64_t prims_in_all, const rt_group* group_array, rt_u32 groups_in_all,
                           const rt_packed_prim* triangle_array, uint64_t triangles_in_all, std::vector<double> values)
    : prims(read_only_copy(prim_array, prims_in_all, "the builder's input prims (read-only)")),
      groups(read_only_copy(group_array, groups_in_all, "the builder's input groups (read-only)")),
      triangles(read_only_copy(triangle_array, triangles_in_all, "the builder's input triangles (read-only)")),
      params(std::move(values)),
      group_count(groups_in_all),
      prim_count(prims_in_all),
      triangle_count(triangles_in_all) {}

const rt_build_input& BuilderInput::table() {
    geometry_ = {sizeof(rt_geometry), static_cast<const rt_packed_prim*>(triangles.data()), triangle_count};
    table_ = {sizeof(rt_build_input),
              group_count,
              static_cast<const rt_prim*>(prims.data()),
              static_cast<const rt_group*>(groups.data()),
              &geometry_,
              params.data()};
    return table_;
}

std::string BuilderResult::overrun() const {
    for (const Slot& slot : slots)
        if (!slot.memory.intact()) return slot.memory.name();
    return refs.intact() ? "" : refs.name();
}

std::string BuilderResult::breach(const rt_accel& accel) const {
    for (rt_u32 s = 0; s < accel.slot_count; ++s)
        if (!slots[s].allocated) return std::string("never allocated slot ") + accel.slots[s].name;
    if (!leaves_given) return "never asked for the leaves";
    for (size_t g = 0; g < roots.size(); ++g) {
        if (!rooted[g]) return "reported no root for group " + std::to_string(g);
        if (roots[g] >= slots[0].count)
            return "reported root " + std::to_string(roots[g]) + " for group " + std::to_string(g) + ", but slot " +
                   accel.slots[0].name + " has " + std::to_string(slots[0].count) + " elements";
    }
    return {};
}

GuardedOutput::GuardedOutput(const rt_accel& accel, rt_u32 group_count, HostServices& services)
    : accel_(accel), group_count_(group_count), services_(services) {
    result_.slots.resize(accel.slot_count);
    result_.roots.assign(group_count, 0);
    result_.rooted.assign(group_count, false);
    table_.struct_bytes = sizeof table_;
    table_.ctx = this;
    table_.alloc = [](void* ctx, rt_u32 slot, uint64_t count) { return output(ctx).alloc(slot, count); };
    table_.leaves = [](void* ctx, uint64_t count) { return output(ctx).leaves(count); };
    table_.root = [](void* ctx, rt_u32 group, rt_u32 node) {
        GuardedOutput& out = output(ctx);
        const std::lock_guard<std::mutex> lock(out.mutex_);
        if (group >= out.group_count_) {
            out.refuse("reported a root for group " + std::to_string(group) + " of " + std::to_string(out.group_count_));
            return;
        }
        out.result_.rooted[group] = true;
        out.result_.roots[group] = node;
    };
    table_.define = [](void* ctx, const char* name, rt_u32 value) {
        GuardedOutput& out = output(ctx);
        const std::lock_guard<std::mutex> lock(out.mutex_);
        if (is_identifier(name))
            out.result_.defines[name] = value;
        else
            out.refuse(std::string("gave a define the name '") + (name ? name : "NULL") + "', which is no identifier");
    };
    table_.stat = [](void* ctx, const char* label, double value) {
        GuardedOutput& out = output(ctx);
        const std::lock_guard<std::mutex> lock(out.mutex_);
        if (label)
            out.result_.stats.emplace_back(label, value);
        else
            out.refuse("gave a stat no label");
    };
}

void* GuardedOutput::alloc(rt_u32 slot, uint64_t count) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (slot >= accel_.slot_count)
        return refuse("asked for slot " + std::to_string(slot) + " of " + std::to_string(accel_.slot_count));
    const std::string name = accel_.slots[slot].name;
    BuilderResult::Slot& out = result_.slots[slot];
    if (out.allocated) return refuse("allocated slot " + name + " twice");
    if (count > kSlotLimit / accel_.slots[slot].elem_bytes)
        return refuse("asked for " + std::to_string(count) + " elements of slot " + name);
    out.allocated = true;
    try {
        out.memory = GuardedBytes(count * accel_.slots[slot].elem_bytes, "slot " + name);
    } catch (const std::bad_alloc&) {
        return refuse("no memory for " + std::to_string(count) + " elements of slot " + name);
    }
    out.count = count;
    return out.memory.data();
}

rt_u32* GuardedOutput::leaves(uint64_t count) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (result_.leaves_given) return static_cast<rt_u32*>(refuse("asked for the leaves twice"));
    if (count > RT_REF_INDEX_MAX) return static_cast<rt_u32*>(refuse("asked for " + std::to_string(count) + " leaves"));
    result_.leaves_given = true;
    try {
        result_.refs = GuardedBytes(count * sizeof(rt_u32), "the leaves");
    } catch (const std::bad_alloc&) {
        return static_cast<rt_u32*>(refuse("no memory for " + std::to_string(count) + " leaves"));
    }
    result_.leaf_count = count;
    return static_cast<rt_u32*>(result_.refs.data());
}

// Fails the build. Returns nullptr for alloc() and leaves().
void* GuardedOutput::refuse(const std::string& why) {
    services_.fail("the builder " + why);
    return nullptr;
}

}  // namespace clarity
