#include "render/trial/worker/guarded_accel.hpp"

#include <cstring>
#include <utility>

namespace clarity {

GuardedAccel::GuardedAccel(const AccelData& built) {
    const auto guarded = [&](const AlignedBytes& from, const std::string& name) {
        GuardedBytes& copy = memory_.emplace_back(from.bytes(), name);
        if (from.bytes() > 0) std::memcpy(copy.data(), from.data(), from.bytes());
        copy.make_read_only();
        return AlignedBytes::borrow(copy.data(), copy.bytes());
    };
    accel_ = std::make_shared<AccelData>();
    AccelData& a = *accel_;
    a.plugin = built.plugin;
    a.layout = built.layout;
    a.params = built.params;
    a.leaf_count = built.leaf_count;
    a.roots = built.roots;
    a.defines = built.defines;
    a.stats = built.stats;
    a.instances = built.instances;
    a.scene = built.scene;
    a.bytes = built.bytes;
    for (size_t i = 0; i < built.slots.size(); ++i) {
        AccelData::Slot slot;
        slot.memory = guarded(built.slots[i].memory, std::string("the slot ") + built.layout->accel->slots[i].name);
        slot.count = built.slots[i].count;
        a.slots.push_back(std::move(slot));
    }
    a.leaves = guarded(built.leaves, "the leaves");
}

}  // namespace clarity
