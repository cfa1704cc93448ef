// triangle_mesh.hpp -- meshes that are computed: they grow triangle by triangle, and then a scene takes them.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace clarity {

using Point = std::array<float, 3>;

// A grid of rows x columns cells.
struct Grid {
    rt_u32 rows, columns;
    // The two triangles of a cell, by its corners: 0 at (row, column), 1 at (row, column + 1), 2 at (row + 1, column), 3 at
    // (row + 1, column + 1).
    std::array<std::array<rt_u32, 3>, 2> cut;
    bool rows_meet = false, columns_meet = false;  // the last row or column is the first one, and has no vertices of its own
    bool first_is_point = false,
         last_is_point = false;  // all vertices of that row are at one place: no triangle has two of them
};
// Cell corners 0 1 3 2 go around the cell; so do 0 2 3 1, the other way.
inline constexpr std::array<std::array<rt_u32, 3>, 2> kCut013{{{0, 1, 3}, {0, 3, 2}}}, kCut023{{{0, 2, 3}, {0, 3, 1}}};

struct TriangleMesh {
    std::vector<float> positions, normals, uvs;  // normals, uvs: of every vertex, or none
    std::vector<rt_u32> triangles;

    rt_u32 vertex_count() const { return static_cast<rt_u32>(positions.size() / 3); }
    rt_u32 triangle_count() const { return static_cast<rt_u32>(triangles.size() / 3); }
    Point vertex(rt_u32 i) const { return {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}; }
    // Whether every edge belongs to exactly two triangles, which traverse it in opposite directions.
    bool is_closed() const;

    // Each returns the vertex's number.
    rt_u32 add_vertex(double x, double y, double z) { return add_vertex(Vec{x, y, z}); }
    rt_u32 add_vertex(const Vec& at);
    rt_u32 add_vertex(const Vec& at, const Vec& normal, double u, double v);
    void add_triangle(rt_u32 a, rt_u32 b, rt_u32 c) { triangles.insert(triangles.end(), {a, b, c}); }
    // With vertices of their own. A quadrangle is the triangles abc and acd.
    void add_triangle(const Point& a, const Point& b, const Point& c);
    void add_quad(const Vec& a, const Vec& b, const Vec& c, const Vec& d);
    void add_quad(const Point& a, const Point& b, const Point& c, const Point& d);
    // add: adds the vertex at a row and a column; it is called row by row.
    void add_grid(const Grid& grid, const std::function<void(rt_u32 row, rt_u32 column)>& add);
    void add_box(const Vec& lo, const Vec& hi);  // eight vertices
    // Around the y axis, from the top down, in single precision; all of a pole's vertices are at one place.
    void add_ball(const Point& center, float radius, int segments, int rings);

    void add(const TriangleMesh& other);
    void transform(double scale, const Vec& offset);
};

// Closed meshes. Segments go around the y axis, rings from pole to pole. Every corner is one vertex.
TriangleMesh uv_sphere(double radius, unsigned segments, unsigned rings);
TriangleMesh torus(double major, double minor, unsigned segments, unsigned sides);
TriangleMesh box(double half_size);

// Adds the mesh, all of one material. Returns its number. A scene without materials gets the default one.
rt_u32 add_mesh(Scene& scene, TriangleMesh mesh, rt_u32 material = 0, const std::string& name = {});
// Adds an instance, which has the mesh's name.
Instance& place(Scene& scene, rt_u32 mesh, const Affine& world_from_object = kIdentity, rt_u32 material = RT_NONE);

}  // namespace clarity
