#include "moving/on_device/read_back.hpp"

#include <algorithm>
#include <cstring>

namespace clarity {

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

}  // namespace clarity
