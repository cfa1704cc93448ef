// mesh_writer.hpp -- writes meshes that are computed into a scene.
#pragma once
#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace clarity::bench {

// A mesh that grows at the end of the scene's arrays.
class MeshWriter {
 public:
    explicit MeshWriter(Scene& scene) : scene_(scene) {
        if (scene.materials.empty()) scene.materials.push_back({"default", default_material()});
        mesh_.first_vertex = scene.vertex_count();
        mesh_.first_triangle = scene.triangle_count();
    }
    rt_u32 vertex(const Vec& p) {
        for (int k = 0; k < 3; ++k) scene_.positions.push_back(static_cast<float>(p[k]));
        return mesh_.first_vertex + mesh_.vertex_count++;
    }
    void triangle(rt_u32 a, rt_u32 b, rt_u32 c) {
        for (const rt_u32 v : {a, b, c}) scene_.triangles.push_back(v);
        scene_.triangle_materials.push_back(0);
        ++mesh_.triangle_count;
        ++mesh_.polygon_count;
    }
    void quad(const Vec& a, const Vec& b, const Vec& c, const Vec& d) {
        const rt_u32 first = vertex(a);
        vertex(b), vertex(c), vertex(d);
        triangle(first, first + 1, first + 2);
        triangle(first, first + 2, first + 3);
    }
    rt_u32 triangles() const { return mesh_.triangle_count; }
    // Ends the mesh. Returns its number.
    rt_u32 end() {
        scene_.meshes.push_back(mesh_);
        return static_cast<rt_u32>(scene_.meshes.size() - 1);
    }
    void end_and_place() { place(scene_, end(), kIdentity); }
    static void place(Scene& scene, rt_u32 mesh, const Affine& at) {
        Instance instance;
        instance.mesh = mesh;
        instance.world_from_object = at;
        scene.instances.push_back(instance);
    }

 private:
    Scene& scene_;
    Mesh mesh_;
};

}  // namespace clarity::bench
