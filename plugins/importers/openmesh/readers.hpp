// readers.hpp -- one function per format. Each reads the bytes of a file into a FlatMesh, which load() finishes.
#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "../common/mesh_arrays.hpp"
#include "rt_plugin.h"

namespace openmesh_import {

// The vertices and faces of a file in flat arrays. Every face is kept: also those of area zero, and several
// at one edge.

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

// The input of a reader. Readers throw std::runtime_error with the reason (without the file's name).
struct Source {
    std::string path;
    std::string_view bytes;
    std::function<void(float)> progress;  // takes 0..1; throws to cancel
    const rt_scene_sink& sink;
};
// What a reader tells besides the mesh.
struct Reading {
    std::string texture;  // of the whole mesh (MeshLab's "comment TextureFile" in PLY), or empty
    std::function<std::string(size_t face)> place_of_face;  // "line 7: ", for messages; may be empty
    rt_u32 first_number = 0;                                // with which the file counts vertices
    uint64_t points_and_lines = 0;                          // elements of a sound file that has no faces, or has them besides
};

void warn(const Source& source, const std::string& text);

Reading read_obj(const Source& source, FlatMesh& mesh);
Reading read_ply(const Source& source, FlatMesh& mesh);
Reading read_ply_points(const Source& source, FlatMesh& mesh);  // a file without faces: its vertices alone
Reading read_stl(const Source& source, FlatMesh& mesh);
Reading read_off(const Source& source, FlatMesh& mesh);
Reading read_om(const Source& source, FlatMesh& mesh);

// Returns a message such as "declares 4294967295 elements 'vertex' of at least 12 bytes ..." if `available` bytes cannot hold
// that many elements, or an empty string if they can.
std::string too_large(const char* what, unsigned long long count, unsigned long long least_bytes, unsigned long long available);

// Reports the share of a file that was read, at every 16384th call.
class Steps {
 public:
    explicit Steps(const Source& source) : source_(source) {}
    template <class Fraction>
    void step(const Fraction& fraction) {
        if (++count_ % 16384 == 0 && source_.progress) source_.progress(fraction());
    }

 private:
    const Source& source_;
    size_t count_ = 0;
};

}  // namespace openmesh_import
