// mtl.hpp -- reads Wavefront material files.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "../common/materials.hpp"
#include "rt_plugin.h"

namespace openmesh_import {

// A map: the picture, and how it lies on the faces.
struct ObjTexture {
    // What the statement may mean by the picture's name, the likeliest first: names may hold blanks, numbers and '#'.
    std::vector<std::string> names;
    float scale[2] = {1, 1}, offset[2] = {0, 0};  // uv in the picture = uv of the corner * scale + offset
    bool clamped = false;
    float bump = 1;  // -bm: by which heights are multiplied
};
// A use of a picture, RT_MAP_..., in a colour space, RT_SPACE_...
struct ObjMap {
    rt_u32 use, space;
    ObjTexture texture;
};
struct ObjMaterial {
    rt_material_desc values{};  // without name, texture and keys
    importers::MaterialKeys keys;
    std::vector<ObjMap> maps;
    std::vector<std::string> left_out;  // statements that say more than is obeyed, such as "map_Kd -mm", each once
    std::string folder;                 // of its library, relative to that of the OBJ file, with a slash at its end; or empty
};

struct Library {
    std::map<std::string, ObjMaterial, std::less<>> materials;
    // A name may be followed by a comment here or where it is used: "Material #1 # oak" is also found as "Material #1".
    const ObjMaterial* find(std::string_view name) const;
};

// Adds the materials of one file. A material that is known already stays as it is. Lines that cannot be understood are skipped,
// as other programs do.
void parse_mtl(std::string_view text, const std::string& folder, Library& library);

}  // namespace openmesh_import
