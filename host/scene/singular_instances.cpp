#include "scene/singular_instances.hpp"

#include "base/error.hpp"

namespace clarity {

void bake_singular_instances(Scene& scene) {
    Affine inverse;
    for (Instance& instance : scene.instances) {
        if (invert(instance.world_from_object, inverse)) continue;
        const Mesh source = scene.meshes[instance.mesh];
        if (uint64_t(scene.vertex_count()) + source.vertex_count >= RT_NONE ||
            uint64_t(scene.triangle_count()) + source.triangle_count > RT_REF_INDEX_MAX) {
            throw Error(Exit::import_failed, "the scene has more vertices or triangles than it can hold");
        }
        Mesh baked = source;
        baked.first_vertex = scene.vertex_count();
        baked.first_triangle = scene.triangle_count();
        const auto repeat = [](auto& shared, size_t first, size_t count) {
            auto& values = shared.own();
            values.reserve(values.size() + count);
            for (size_t i = first; i < first + count; ++i) values.push_back(values[i]);
        };
        for (size_t v = source.first_vertex; v < size_t(source.first_vertex) + source.vertex_count; ++v) {
            const std::array<float, 3> p = transform_point(instance.world_from_object, &scene.positions[3 * v]);
            scene.positions.append(p.begin(), p.end());
        }
        // The copy has no vertex normals; it is shaded with the normals of its triangles.
        if (!scene.normals.empty()) scene.normals.resize(scene.positions.size(), 0.f);
        if (!scene.uvs.empty()) repeat(scene.uvs, 2 * size_t(source.first_vertex), 2 * size_t(source.vertex_count));
        if (!scene.uvs2.empty()) repeat(scene.uvs2, 2 * size_t(source.first_vertex), 2 * size_t(source.vertex_count));
        if (!scene.colors.empty()) repeat(scene.colors, 4 * size_t(source.first_vertex), 4 * size_t(source.vertex_count));
        repeat(scene.triangle_materials, source.first_triangle, source.triangle_count);
        const size_t first = 3 * size_t(source.first_triangle), count = 3 * size_t(source.triangle_count);
        for (size_t i = first; i < first + count; ++i) {
            scene.triangles.push_back(scene.triangles[i] - source.first_vertex + baked.first_vertex);
        }
        if (!scene.tangents.empty()) repeat(scene.tangents, first, count);
        instance.mesh = static_cast<rt_u32>(scene.meshes.size());
        instance.world_from_object = kIdentity;
        scene.meshes.push_back(std::move(baked));
    }
}

}  // namespace clarity
