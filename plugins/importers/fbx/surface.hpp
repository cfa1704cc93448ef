// surface.hpp -- physically based materials of FBX files: what their properties are to the host.
#pragma once
#include "../common/materials.hpp"
#include "properties.hpp"

namespace fbx_import {

// What a property is called whatever program wrote it: `3dsMax|Parameters|base_color_map`, `Maya|baseColor|file` and
// `3dsMax|main|baseColor` are basecolor.
std::string plain_name(std::string_view property);

// A texture that hangs from a property of that plain name.
struct SurfaceMap {
    const char* name;
    rt_u32 use, space;
};
const SurfaceMap* surface_map(std::string_view plain);

// The properties of one material that have a program's prefix, by their plain names.
class Surface {
 public:
    explicit Surface(const Properties& properties);
    // Whether the material is one of the models that surface.cpp lists.
    bool is_physical() const { return number_of("basecolor") != nullptr; }
    // maps: those that the material has; a picture replaces its value. Adds what is not understood to left_out.
    void read(const std::vector<rt_map_desc>& maps, bool has_color_map, MaterialKeys& keys, AlphaKeys& alpha,
              rt_material_desc& out, std::vector<std::string>& left_out) const;

 private:
    const Vec3* number_of(std::string_view name) const;
    double number(std::string_view name, double otherwise) const;
    Vec3 color(std::string_view name, const Vec3& otherwise) const;
    void read_color(bool has_color_map, MaterialKeys& keys, rt_material_desc& out) const;
    void read_emission(const std::vector<rt_map_desc>& maps, rt_material_desc& out) const;
    std::unordered_map<std::string, Vec3> values_;
};

}  // namespace fbx_import
