// generated.hpp -- scenes made by formula, so that the expected results need no file.
#pragma once
#include <array>
#include <vector>

#include "support/workbench.hpp"

namespace clarity::test {

using Point = std::array<float, 3>;

// A mesh of triangles that share corners, as in a file.
struct TriangleMesh {
    std::vector<float> positions;
    std::vector<rt_u32> triangles;

    rt_u32 add_vertex(double x, double y, double z);
    void add_triangle(rt_u32 a, rt_u32 b, rt_u32 c);
    void add(const TriangleMesh& other);
    void transform(double scale, const std::array<double, 3>& offset);
    Point vertex(rt_u32 i) const { return {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}; }
    // Whether every edge belongs to exactly two triangles, which traverse it in opposite directions.
    bool is_closed() const;
};

// Closed meshes. Segments go around the axis, rings from pole to pole. `positions` has every corner once.
TriangleMesh uv_sphere(double radius, unsigned segments, unsigned rings);
TriangleMesh torus(double major, double minor, unsigned segments, unsigned sides);
TriangleMesh box(double half_size);

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
