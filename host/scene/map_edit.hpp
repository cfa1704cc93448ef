// map_edit.hpp -- textures that a user gives to the uses of a material, in place of those of its file.
#pragma once
#include <string>
#include <vector>

#include "base/members.hpp"
#include "scene/scene.hpp"

namespace clarity {

// A picture that no file names: the user gives it to a material.
struct PictureFile {
    std::string path;
    rt_u32 space = RT_SPACE_SRGB;  // RT_SPACE_
    CLARITY_MEMBERS(path, space);
    bool operator==(const PictureFile& b) const { return members_of(*this) == members_of(b); }
};

// All that a user has done to the textures of a scene's materials.
struct MapEdits {
    struct Given {
        rt_u32 material = 0, use = 0;  // RT_MAP_
        rt_u32 texture = RT_NONE;      // of the scene; RT_NONE: the use has none
        bool operator==(const Given& b) const { return material == b.material && use == b.use && texture == b.texture; }
    };
    std::vector<Given> given;  // by material and use, ascending
    bool empty() const { return given.empty(); }
    bool operator==(const MapEdits& b) const { return given == b.given; }
    bool operator!=(const MapEdits& b) const { return !(*this == b); }
    // The texture of a use, as edited; RT_NONE: there is none.
    rt_u32 texture_of(const Scene& scene, rt_u32 material, rt_u32 use) const;
    // What the scene itself has is no edit.
    void give(const Scene& scene, rt_u32 material, rt_u32 use, rt_u32 texture);
    // Forgets what was done to a material.
    void reset(rt_u32 material);
};

// The scene with these textures. A texture lies where that of the use did, else where the colour's does, else as the
// coordinates say. Its colour space is that of the use: a picture of another one is taken for such a one, though its smaller
// pictures stay those of its own. All that is large is shared; tangents that normals need are made.
Scene with_maps(const Scene& scene, const MapEdits& edits);

// Whether both place the same primitives, with the same attributes and numbers of materials, in arrays that they share: a
// structure that was built for one is one for the other.
bool same_geometry(const Scene& a, const Scene& b);

// The texture of that name, rather one of the colour space of the use; of the picture in that file, which has the whole path as
// its name; or of that number. RT_NONE: there is none.
rt_u32 find_texture(const Scene& scene, const std::string& text, rt_u32 use);
// A text for which find_texture() finds it.
std::string texture_word(const Scene& scene, rt_u32 texture, rt_u32 use);
// The whole path by which a texture of such a file is found.
std::string picture_name(const std::string& path);
inline bool is_picture_name(const std::string& name) {
    return !name.empty() && name[0] == '/';
}

}  // namespace clarity
