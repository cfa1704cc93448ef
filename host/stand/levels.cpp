#include "stand/levels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "launch/device_scene.hpp"
#include "plugin/host_services.hpp"
#include "structures/accel_build.hpp"

namespace clarity {
namespace {

struct Sink {
    Volumes& volumes;
    const Affine& world;
    size_t limit;
    bool full() const { return volumes.boxes.size() + volumes.spheres.size() >= limit; }
};

// Upper bound of a transform's scale: the length of its largest column. Exact for rotations with uniform scale.
float scale_of(const Affine& m) {
    float largest = 0;
    for (int column = 0; column < 3; ++column) largest = std::max(largest, std::hypot(m[column], m[4 + column], m[8 + column]));
    return largest;
}

// corner: writes corner i of 0 to 7; bit k of i says on which side it is along axis k.
template <class Corner>
void add_corners(Sink& sink, const Corner& corner) {
    if (sink.full()) return;
    std::array<std::array<float, 3>, 8> corners;
    for (int i = 0; i < 8; ++i) {
        float p[3];
        corner(i, p);
        corners[i] = transform_point(sink.world, p);
    }
    sink.volumes.boxes.push_back(corners);
}

void add_box(void* ctx, const float lo[3], const float hi[3]) {
    add_corners(*static_cast<Sink*>(ctx), [&](int i, float(&p)[3]) {
        for (int k = 0; k < 3; ++k) p[k] = i >> k & 1 ? hi[k] : lo[k];
    });
}

void add_oriented_box(void* ctx, const float center[3], const float halves[9]) {
    add_corners(*static_cast<Sink*>(ctx), [&](int i, float(&p)[3]) {
        for (int k = 0; k < 3; ++k) {
            p[k] = center[k];
            for (int a = 0; a < 3; ++a) p[k] += i >> a & 1 ? halves[3 * a + k] : -halves[3 * a + k];
        }
    });
}

void add_sphere(void* ctx, const float center[3], float radius) {
    Sink& sink = *static_cast<Sink*>(ctx);
    if (sink.full()) return;
    const auto p = transform_point(sink.world, center);
    sink.volumes.spheres.push_back({p[0], p[1], p[2], radius * scale_of(sink.world)});
}

// Returns the slots, roots and instances of a structure that was moved on a device, with everything that accel_volumes() needs;
// it has no leaves. built: the structure as it was built. Waits for the copy. Throws cl::Error.
AccelData read_back(const AccelData& built, const DeviceScene& moved) {
    const DeviceScene::Moving buffers = moved.moving();
    const auto context = buffers.leaves.getInfo<CL_MEM_CONTEXT>();
    // Its own queue, so that frames go on.
    const Queue queue(context, context.getInfo<CL_CONTEXT_DEVICES>().front());
    AccelData now;
    static_cast<AccelFacts&>(now) = built;
    const rt_accel& table = *built.layout->accel;
    size_t on_device = 0;
    for (size_t s = 0; s < built.slots.size(); ++s) {
        const AlignedBytes& memory = built.slots[s].memory;
        now.slots.push_back({AlignedBytes(memory.bytes(), false), built.slots[s].count});
        if (table.slots[s].flags & RT_SLOT_HOST_ONLY)
            std::memcpy(now.slots[s].memory.data(), memory.data(), memory.bytes());
        else
            queue.enqueueReadBuffer(buffers.slots[on_device++], CL_TRUE, 0, memory.bytes(), now.slots[s].memory.data());
    }
    now.instances.resize(built.instances.size());
    if (!now.instances.empty())
        queue.enqueueReadBuffer(buffers.instances, CL_TRUE, 0, now.instances.size() * sizeof(rt_instance),
                                now.instances.data());
    now.scene.group_of_instance = built.scene.group_of_instance;
    for (const rt_instance& instance : now.instances) {
        Affine object_from_world, world_from_object = kIdentity;
        std::copy_n(instance.object_from_world, 12, object_from_world.begin());
        invert(object_from_world, world_from_object);
        now.scene.world_from_object.push_back(world_from_object);
    }
    return now;
}

}  // namespace

Volumes accel_volumes(const AccelData& accel, rt_u32 level, size_t limit, const DeviceScene* moved) {
    if (moved) return accel_volumes(read_back(accel, *moved), level, limit);
    Volumes volumes;
    const rt_accel& table = *accel.layout->accel;
    if (!table.levels) return volumes;
    std::vector<const void*> slots;
    std::vector<uint64_t> counts;
    for (const AccelData::Slot& slot : accel.slots) {
        slots.push_back(slot.memory.data());
        counts.push_back(slot.count);
    }
    const rt_built built{sizeof(rt_built), static_cast<rt_u32>(accel.roots.size()), slots.data(), counts.data(),
                         accel.roots.data()};
    Progress progress;
    const auto add_group = [&](rt_u32 group, const Affine& world) {
        Sink sink{volumes, world, limit};
        const rt_volume_sink calls{sizeof(rt_volume_sink), &sink, add_box, add_sphere, add_oriented_box};
        HostServices services(std::string("accel ") + accel.plugin->id, progress);
        services.check(1, [&] { return table.levels(services.host(), &built, group, level, &calls); });
    };
    add_group(0, kIdentity);
    for (size_t i = 0; i < accel.instances.size(); ++i)
        add_group(accel.scene.group_of_instance[i], accel.scene.world_from_object[i]);
    return volumes;
}

}  // namespace clarity
