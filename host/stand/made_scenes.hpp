// made_scenes.hpp -- scenes by formula: the same on every machine. A seed other than 0 moves what is random in them.
#pragma once
#include <cstdint>
#include <random>
#include <vector>

#include "stand/triangle_mesh.hpp"

namespace clarity {

// Makes a scene: a mesh that grows, and where meshes are placed.
class SceneMaker : public TriangleMesh {
 public:
    // into: the scene to which all is added.
    explicit SceneMaker(uint64_t seed = 0, Scene into = {});

    float random();  // 0 to 1
    Point around(const Point& center, float spread);
    void add_soup(const Point& center, float spread, float size, uint64_t count);
    void add_sphere(const Point& center, float radius) { scene.spheres.push_back({center, radius, 0}); }
    void add_polygon(const std::vector<Point>& corners);

    // Ends the mesh of the triangles since the last call. Returns its number.
    rt_u32 end_mesh();
    Instance& place(rt_u32 mesh, const Affine& world_from_object = kIdentity) {
        return clarity::place(scene, mesh, world_from_object);
    }
    Instance& place_mesh(const Affine& world_from_object = kIdentity) { return place(end_mesh(), world_from_object); }

    Scene scene;

 private:
    std::mt19937 random_;
};

// A turn about a slanted axis, with a scale for each axis and a translation.
Affine placed(const Point& at, float angle, const Point& scale);

// The catalogue. Each adds about so many triangles, and leaves the last mesh to the caller, who ends and places it.
namespace made {

// Tiers and a field around what is there, 200 times as wide: a little detail in much space.
void stadium(SceneMaker& make, uint64_t triangles);
// Strands on a ball, each 400 times as long as wide, in all directions.
void hair(SceneMaker& make, uint64_t triangles);
// Four kinds of houses with windows, placed in 40 x 40 lots as instances.
void city(SceneMaker& make, uint64_t triangles);
// A square of hills, one height for each of k x k points.
void height_field(SceneMaker& make, uint64_t triangles);
// Triangles of one size and of all directions, at random in a cube, which overlap.
void soup(SceneMaker& make, uint64_t triangles);

// These lie in a cube from -1 to 1, and the seed moves them.

// Boxes of all heights on a square, most of them low, side by side.
void blocks(SceneMaker& make, uint64_t triangles);
// Triangles of any size and place.
void mixed_soup(SceneMaker& make, uint64_t triangles);
// Long thin ones: their boxes overlap whatever one does.
void needles(SceneMaker& make, uint64_t triangles);
// A few finely divided balls in a large hall, 40 wide: nearly all triangles in little of the space.
void teapots(SceneMaker& make, uint64_t triangles);
// Triangles of all sizes, a few large ones among many small ones, in crowds and between them: where the halves of a list part
// is no good place for a plane.
void crowds(SceneMaker& make, uint64_t triangles);

}  // namespace made

}  // namespace clarity
