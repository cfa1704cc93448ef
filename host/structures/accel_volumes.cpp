#include "structures/accel_volumes.hpp"

#include <algorithm>
#include <cmath>

#include "plugin/host_services.hpp"

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

}  // namespace

Volumes accel_volumes(const AccelData& accel, rt_u32 level, size_t limit) {
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
