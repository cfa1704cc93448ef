// obj_libraries.hpp -- finds the material libraries and pictures that an OBJ file names, and gives its materials to the host.
#pragma once
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "mtl.hpp"
#include "readers.hpp"

namespace openmesh_import {

class ObjLibraries {
 public:
    // lines: what stands behind each `mtllib`. Reads the libraries, and warns about those that cannot be read.
    ObjLibraries(const Source& source, const std::vector<std::string>& lines);

    // The material of a name that is used behind `before` lines with libraries: of the last of them that has it, or else of the
    // first line behind. nullptr: there is none.
    const ObjMaterial* find(const std::string& name, size_t before) const;
    // The host's number of a material, which it gets at the first call. Warns if there is none.
    rt_u32 id(const std::string& name, const ObjMaterial* material);

 private:
    void read_line(std::string_view line, Library& library);
    bool read_file(std::string name, Library& library);
    void warn_of_left_out(const std::string& name, const ObjMaterial& material) const;
    std::string picture(const ObjMaterial& material, const std::vector<std::string>& names) const;
    rt_u32 texture(const ObjMaterial& material, const ObjMap& map);

    const Source& source_;
    const std::string folder_;  // of the OBJ file
    std::vector<Library> libraries_;
    std::map<const ObjMaterial*, rt_u32> ids_;
    std::map<std::tuple<std::string, bool, rt_u32>, rt_u32> textures_;  // by picture, clamped, space
    std::set<std::string> unknown_;
    bool has_missing_ = false;
};

}  // namespace openmesh_import
