#include "moving/moved_instances.hpp"

#include <algorithm>

namespace clarity {

std::string name_of(const Instance& instance, size_t number) {
    return "instance " + (instance.name.empty() ? std::to_string(number) : "`" + instance.name + "`");
}

void find_moved_instances(const Scene& scene, const BuildScene& build, const std::vector<PosedInstance>& now, const Pose& pose,
                          MovedInstances& moved) {
    moved.why.clear();
    moved.numbers.clear();
    moved.inverses.clear();
    if (pose.instances.size() != now.size()) {
        moved.why =
            "the pose has " + std::to_string(pose.instances.size()) + " instances, the structure " + std::to_string(now.size());
        return;
    }
    Affine inverse = kIdentity;
    for (size_t i = 0; i < now.size(); ++i) {
        const PosedInstance& next = pose.instances[i];
        const Instance& instance = scene.instances[i];
        const bool alone = build.number_of_instance[i] != RT_NONE;
        if (next.visible != now[i].visible && !alone)
            moved.why = name_of(instance, i) + (next.visible ? " appears" : " is hidden");
        else if (next.mesh != now[i].mesh)
            moved.why = name_of(instance, i) + " has another mesh";
        else if (next.world_from_object == now[i].world_from_object && next.visible == now[i].visible)
            continue;
        else if (next.visible && !invert(next.world_from_object, inverse))
            moved.why = name_of(instance, i) + " is scaled to nothing";
        else if (next.visible && !alone && mirrors(next.world_from_object))
            moved.why = name_of(instance, i) + " is mirrored";
        if (!moved.why.empty()) return;
        moved.numbers.push_back(static_cast<rt_u32>(i));
        moved.inverses.push_back(inverse);
    }
}

bool moves_flattened_mesh(const Pose& pose, const Scene& scene, const BuildScene& build) {
    const std::vector<rt_u32> meshes = deforming_meshes(pose);
    return std::any_of(build.flattened.begin(), build.flattened.end(), [&](uint32_t i) {
        return pose.instances[i].world_from_object != scene.instances[i].world_from_object ||
               std::binary_search(meshes.begin(), meshes.end(), scene.instances[i].mesh);
    });
}

Problem wrong_vertices(const Scene& scene, const Pose& pose) {
    for (const PosedMesh& mesh : pose.meshes)
        if (mesh.mesh >= scene.meshes.size() || mesh.positions.size() != 3 * size_t(scene.meshes[mesh.mesh].vertex_count))
            return "mesh " + std::to_string(mesh.mesh) + " has another number of vertices";
    return {};
}

}  // namespace clarity
