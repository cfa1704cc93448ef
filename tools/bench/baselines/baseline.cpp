#include "tools/bench/baselines/baseline.hpp"

#ifdef CLARITY_EMBREE
#include "tools/bench/baselines/embree_baseline.hpp"
#endif

namespace clarity::bench {

BaselineMesh make_baseline_mesh(const Scene& scene) {
    BaselineMesh mesh;
    for (const Instance& instance : scene.instances) {
        const Mesh& from = scene.meshes[instance.mesh];
        const bool placed = instance.world_from_object != kIdentity;
        const rt_u32 first = mesh.vertex_count();
        for (rt_u32 v = from.first_vertex; v < from.first_vertex + from.vertex_count; ++v) {
            const float* p = &scene.positions[3 * size_t(v)];
            const std::array<float, 3> q =
                placed ? transform_point(instance.world_from_object, p) : std::array<float, 3>{p[0], p[1], p[2]};
            mesh.positions.insert(mesh.positions.end(), q.begin(), q.end());
        }
        if (!scene.normals.empty()) {
            // Normals are transformed by the inverse transpose. Their length does not matter, only their proportions within a
            // mesh.
            Affine m = kIdentity;
            if (placed) invert(instance.world_from_object, m);
            for (size_t v = from.first_vertex; v < size_t(from.first_vertex) + from.vertex_count; ++v) {
                const float* n = &scene.normals[3 * v];
                for (int k = 0; k < 3; ++k) mesh.normals.push_back(m[k] * n[0] + m[4 + k] * n[1] + m[8 + k] * n[2]);
            }
        }
        for (size_t i = 0; i < 3 * size_t(from.triangle_count); ++i)
            mesh.triangles.push_back(scene.triangles[3 * size_t(from.first_triangle) + i] - from.first_vertex + first);
    }
    mesh.positions.push_back(0);
    return mesh;
}

Problem baselines_cannot(const Scene& scene) {
    if (!scene.spheres.empty() || !scene.planes.empty() || !scene.polygons.empty() || !scene.shapes.empty())
        return "they trace triangles only, and the scene has spheres, planes, polygons or shapes";
    if (scene.placed_triangle_count() == 0) return "the scene has no triangles";
    return {};
}

std::vector<BaselineKind> baseline_kinds(std::string* why) {
#ifdef CLARITY_EMBREE
    (void)why;
    return {{"embree", "low", build_embree}, {"embree", "medium", build_embree}, {"embree", "high", build_embree}};
#else
    if (why) *why = "this program was built without Embree (libembree-dev): no peers";
    return {};
#endif
}

#ifndef CLARITY_EMBREE
std::unique_ptr<MovingBaseline> make_moving_baseline(const BaselineMesh&, const std::string&, unsigned) {
    return nullptr;
}
std::string baseline_version() {
    return {};
}
#endif

}  // namespace clarity::bench
