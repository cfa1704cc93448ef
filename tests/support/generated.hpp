// generated.hpp -- scenes made by formula, whose truth needs no file.
#pragma once
#include <array>
#include <vector>

#include "support/workbench.hpp"

namespace clarity::test {

using Point = std::array<float, 3>;

// Corners shared between triangles, as in a file.
struct TriangleMesh {
    std::vector<float> positions;
    std::vector<rt_u32> triangles;

    rt_u32 add_vertex(double x, double y, double z);
    void add_triangle(rt_u32 a, rt_u32 b, rt_u32 c);
    void add(const TriangleMesh& other);
    void transform(double scale, const std::array<double, 3>& offset);
    Point vertex(rt_u32 i) const { return {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}; }
    // Whether every edge has exactly two triangles, which run along it in opposite directions.
    bool is_closed() const;
};

// Closed meshes. Segments around the axis, rings from pole to pole; every corner stands once in `positions`.
TriangleMesh uv_sphere(double radius, unsigned segments, unsigned rings);
TriangleMesh torus(double major, double minor, unsigned segments, unsigned sides);
TriangleMesh box(double half_size);

// A scene of one mesh, one instance of it, default material.
Scene scene_of(const TriangleMesh& mesh);
ScenePtr shared_scene(Scene scene);

// 3000 triangles anywhere within -2..2: large and tiny, needles, points and lines, some of them several times at one place.
ScenePtr rubble();

// Adds a material and gives its number.
rt_u32 add_material(Scene& scene, const rt_material& values);
rt_material diffuse(float r, float g, float b);
rt_material mirror(float reflect);
rt_material glass(float ior);

// A camera that looks along -z from `eye`.
View view_from(const Point& eye, const Point& target, double fov_deg);

}  // namespace clarity::test
