// flat_mesh.hpp -- the vertices and faces of a file in flat arrays. Every face is kept: also those of area zero, and several
// at one edge.
#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "../common/mesh_arrays.hpp"

namespace openmesh_import {

// Readers fill the arrays in any order, with faces that may name vertices that follow later. finish() then checks them.
class FlatMesh : public importers::MeshArrays {
 public:
    std::vector<rt_u32> corners;         // vertices of all faces, one after the other; RT_NONE: a number out of range
    std::vector<rt_u32> face_materials;  // of each face, or empty
    // Normals and uvs of corners instead of vertices (OBJ; lists of PLY): their numbers for each corner; RT_NONE: it has none.
    // Empty: no corner has one.
    std::vector<rt_u32> normal_of_corner, uv_of_corner;
    std::vector<float> corner_normals, corner_uvs;  // the values, 3 and 2 for each number

    // Adds a vertex. One that is not finite keeps its number, but faces must not use it.
    void add_vertex(double x, double y, double z);
    // Gives a vertex that was added another position.
    void set_vertex(size_t vertex, double x, double y, double z);
    size_t vertex_count() const { return positions.size() / 3; }
    void add_face(size_t corner_count) { sizes.push_back(static_cast<rt_u32>(corner_count)); }
    // A vertex with a number from a file, as it stands in `corners`.
    static rt_u32 vertex_number(int64_t number) {
        return number < 0 || number >= int64_t(RT_NONE) ? RT_NONE : static_cast<rt_u32>(number);
    }

    // Leaves out the faces that refer to a missing vertex or one that is not finite, and gives corners with different
    // normals and uvs vertices of their own.
    void finish();
    // What finish() left out, and the first of them: the number of the face in the file, and its vertex.
    uint64_t broken_faces = 0;
    size_t first_broken_face = 0;
    rt_u32 first_broken_vertex = 0;

 private:
    bool is_usable(rt_u32 vertex) const {
        return vertex < vertex_count() && (unusable_.size() <= vertex || !unusable_[vertex]);
    }
    void keep_digits(size_t vertex, const double (&at)[3]);
    void subtract_origin();
    void leave_out_broken();
    void copy_vertices();

    // Digits that floats do not hold, one number for each of `positions`, while all vertices together are far from 0: floats
    // near 5e6, as UTM has them, lie half a unit apart. Nearly all files end that with their first vertices.
    bool keeps_digits_ = true, has_digits_ = false;
    std::vector<float> digits_;
    double lo_[3] = {INFINITY, INFINITY, INFINITY}, hi_[3] = {-INFINITY, -INFINITY, -INFINITY};

    std::vector<bool> unusable_;  // may be shorter than the vertices
};

}  // namespace openmesh_import
