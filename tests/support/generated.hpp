// generated.hpp -- scenes made by formula, so that the expected results need no file.
#pragma once
#include "stand/triangle_mesh.hpp"
#include "support/workbench.hpp"

namespace clarity::test {

// A scene with one mesh, one instance of it and the default material.
Scene scene_of(const TriangleMesh& mesh);
ScenePtr shared_scene(Scene scene);

// 3000 triangles within -2..2: large and tiny ones, needles, points and lines, and some several times at the same place.
ScenePtr rubble();

// Adds a material and returns its number.
rt_u32 add_material(Scene& scene, const rt_material& values);
rt_material diffuse(float r, float g, float b);
rt_material mirror(float reflect);
rt_material glass(float ior);

// A camera at `eye` that looks at `target`, and no lights.
View view_from(const Point& eye, const Point& target, double fov_deg);
// The same without light from outside of the scene.
View dark_view(const Point& eye, const Point& target, double fov_deg);

}  // namespace clarity::test
