// mtl.hpp -- Wavefront material files. OpenMesh reads of them no more than a face colour and a texture's name.
#pragma once
#include <map>
#include <string>

#include "rt_plugin.h"

namespace openmesh_import {

struct ObjMaterial {
    rt_material values{};  // .texture is not set
    std::string texture;   // map_Kd as the file has it, or empty
};

// Adds the materials of one file to `materials`, by name. Lines that make no sense are skipped, as all programs do.
void parse_mtl(std::string_view text, std::map<std::string, ObjMaterial>& materials);

}  // namespace openmesh_import
