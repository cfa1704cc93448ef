// readers.hpp -- one function per format. Each reads the bytes of a file into a FlatImporter, through OpenMesh's reader.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "flat_importer.hpp"
#include "rt_plugin.h"
#include "streams.hpp"

namespace openmesh_import {

// The input of a reader. Readers throw std::runtime_error with the reason (without the file's name).
struct Source {
    std::string path;
    std::string_view bytes;
    ReportProgress progress;
    const rt_scene_sink& sink;
};

void warn(const Source& source, const std::string& text);

void read_obj(const Source& source, FlatImporter& mesh);
// Returns the texture of the whole mesh (MeshLab's "comment TextureFile"), or an empty string.
std::string read_ply(const Source& source, FlatImporter& mesh);
void read_stl(const Source& source, FlatImporter& mesh);
void read_off(const Source& source, FlatImporter& mesh);
void read_om(const Source& source, FlatImporter& mesh);

// Runs OpenMesh's reader of a format. Returns false if the reader gave up. stop_at_errors: the stream throws
// std::ios_base::failure at the first datum that cannot be read.
bool run_reader(const char* extension, std::streambuf& buffer, bool stop_at_errors, bool is_binary, bool custom_properties,
                FlatImporter& mesh);

// Returns a message such as "declares 4294967295 elements 'vertex' of at least 12 bytes ..." if `available` bytes cannot hold
// that many elements, or an empty string if they can.
std::string too_large(const char* what, unsigned long long count, unsigned long long least_bytes, unsigned long long available);

}  // namespace openmesh_import
