#include "support/generated.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/angle.hpp"

namespace clarity::test {
Scene scene_of(const TriangleMesh& mesh) {
    Scene scene;
    scene.materials.push_back({"default", default_material()});
    if (mesh.triangle_count()) place(scene, add_mesh(scene, mesh));
    return scene;
}

ScenePtr shared_scene(Scene scene) {
    return std::make_shared<const Scene>(std::move(scene));
}

rt_u32 add_material(Scene& scene, const rt_material& values) {
    scene.materials.push_back({"", values});
    return static_cast<rt_u32>(scene.materials.size() - 1);
}

rt_material diffuse(float r, float g, float b) {
    rt_material m{};
    m.color[0] = r;
    m.color[1] = g;
    m.color[2] = b;
    m.shininess = 1;
    m.ior = 1;
    m.texture = RT_NONE;
    return m;
}

rt_material mirror(float reflect) {
    rt_material m = diffuse(0, 0, 0);
    m.reflect = reflect;
    return m;
}

rt_material glass(float ior) {
    rt_material m = diffuse(1, 1, 1);
    m.refract = 1;
    m.ior = ior;
    return m;
}

View view_from(const Point& eye, const Point& target, double fov_deg) {
    View view;
    view.camera.eye = eye;
    view.camera.target = target;
    view.camera.fov_y_rad = static_cast<float>(fov_deg * kPi / 180);
    return view;
}

View dark_view(const Point& eye, const Point& target, double fov_deg) {
    View view = view_from(eye, target, fov_deg);
    view.background = view.ambient = {0, 0, 0};
    return view;
}

ScenePtr rubble() {
    static const ScenePtr scene = [] {
        std::mt19937 random(11);
        std::uniform_real_distribution<double> at(-1, 1), decade(-4, 0);
        TriangleMesh mesh;
        for (int i = 0; i < 3000; ++i) {
            double corner[3][3];
            const double size = std::pow(10.0, decade(random));
            const double center[3] = {at(random), at(random), at(random)};
            for (auto& c : corner)
                for (int k = 0; k < 3; ++k) c[k] = center[k] + size * at(random);
            if (i % 7 == 0) std::copy_n(corner[0], 3, corner[1]);
            if (i % 11 == 0)
                for (int k = 0; k < 3; ++k) corner[2][k] = corner[0][k] + 1e-6 * at(random);
            if (i % 5 == 0)
                corner[0][i % 3] = corner[1][i % 3] = corner[2][i % 3] = 0.25;  // in a plane perpendicular to an axis
            for (int copies = i % 13 == 0 ? 6 : 1; copies > 0; --copies) {
                rt_u32 v[3];
                for (int c = 0; c < 3; ++c) v[c] = mesh.add_vertex(corner[c][0], corner[c][1], corner[c][2]);
                mesh.add_triangle(v[0], v[1], v[2]);
            }
        }
        return shared_scene(scene_of(mesh));
    }();
    return scene;
}

}  // namespace clarity::test
