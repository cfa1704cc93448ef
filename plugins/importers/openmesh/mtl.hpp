// mtl.hpp -- reads Wavefront material files. OpenMesh reads only a face colour and the name of a texture from them.
#pragma once
#include <map>
#include <string>

#include "rt_plugin.h"

namespace openmesh_import {

struct ObjMaterial {
    rt_material_desc values{};  // without name and texture
    std::string texture;        // map_Kd as in the file, or empty
};

// Adds the materials of one file to `materials`, by name. Lines that cannot be understood are skipped, as other programs do.
void parse_mtl(std::string_view text, std::map<std::string, ObjMaterial>& materials);

}  // namespace openmesh_import
