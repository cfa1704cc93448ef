// tangents.hpp -- the directions of a triangle's corners along which a map of normals has its x.
//
// A tangent is kept as the direction in the triangle's plane that becomes it when it is made perpendicular to the corner's
// normal: by its two components along the edge from the first corner to the second, and across it on the side of the third. So
// it follows the triangle into any pose. A word of Scene::tangents holds them for a corner, 15 bits each, in bits 1 to 15 and
// 17 to 31, times 16383. Bit 0 of a triangle's first word says that the texture is mirrored: the bitangent is -cross(normal,
// tangent). Three words of 0: there are none.
#pragma once
#include <array>

#include "scene/scene.hpp"

namespace clarity {

// Sets the tangents of a triangle from those of its vertices. tangents: x, y, z and handedness (see rt_mesh) of each vertex
// from first_vertex on. Nothing changes where they are 0 or not finite. Scene::tangents has room for the triangle.
void store_tangents(Scene& scene, rt_u32 triangle, const std::vector<float>& tangents, rt_u32 first_vertex);

// Makes the tangents of triangles that need some and have none: those whose material, or that of an instance of their mesh, has
// a map of normals or a grain. As Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited", appendix A: at each corner the
// directions along u of the triangles with the same position, normal, coordinates and handedness, weighted by their angles.
// (There, triangles also have to be connected by edges; here, those that only share the corner count, too.)
void make_tangents(Scene& scene);

}  // namespace clarity
