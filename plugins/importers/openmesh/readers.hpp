// readers.hpp -- one function per format: from a file's bytes into a FlatImporter, through OpenMesh's reader.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "flat_importer.hpp"
#include "rt_plugin.h"
#include "streams.hpp"

namespace openmesh_import {

// What a reader is given. Failures are exceptions that say why (without the file's name).
struct Source {
    std::string path;
    std::string_view bytes;
    ReportProgress progress;
    const rt_scene_sink& sink;
};

void warn(const Source& source, const std::string& text);

void read_obj(const Source& source, FlatImporter& mesh);
// Texture of the whole mesh (MeshLab's "comment TextureFile"), or empty.
std::string read_ply(const Source& source, FlatImporter& mesh);
void read_stl(const Source& source, FlatImporter& mesh);
void read_off(const Source& source, FlatImporter& mesh);
void read_om(const Source& source, FlatImporter& mesh);

// Runs OpenMesh's reader of a format. `stop_at_errors`: the stream throws at the first thing that it cannot read.
// False: the reader gave up.
bool run_reader(const char* extension, std::streambuf& buffer, bool stop_at_errors, bool is_binary, bool custom_properties,
                FlatImporter& mesh);

// "4294967295 vertices need at least 48 GB, the file has 12 bytes for them" if so; empty if they fit.
std::string too_large(const char* what, unsigned long long count, unsigned long long least_bytes, unsigned long long available);

}  // namespace openmesh_import
