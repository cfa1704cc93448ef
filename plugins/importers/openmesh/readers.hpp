// readers.hpp -- one function per format. Each reads the bytes of a file into a FlatMesh, which load() finishes.
#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "flat_mesh.hpp"
#include "rt_plugin.h"

namespace openmesh_import {

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
