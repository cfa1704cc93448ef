// edit.hpp -- changes to a scene's view as text. Presets, command lines and the window use the same words.
//
//   camera       ex,ey,ez,tx,ty,tz,fov_deg,ux,uy,uz[,aperture,focus]      camera.aperture, camera.focus   a length
//   background, ambient   r,g,b
//   light.N      off | KIND | KIND,numbers of its keys in the order of light_kinds.hpp, as point,x,y,z,r,g,b. N counts the
//   view's
//                lights from 0; N = their number adds one
//   light.N.KEY  one key of that light: spot's angle, rect's two_sided (true or false)
//   sky          KIND of sky_kinds.hpp: gradient; picture if the scene's files name one
//   sky.KEY      one key of the sky's kind: sky.strength, sky.zenith
//   camera_path  t:camera;t:camera;...: the camera at times of the clip; see camera_path.hpp
//   material.N.KEY  one of material_keys.hpp: color (r,g,b), reflect (a number), model (a word), checker (true or false)
//   material.N.USE  one of map_uses.hpp, as normal_map: none, or a texture of the scene (find_texture() in map_edit.hpp)
//   hide         instances that the picture leaves out: 3,5-9
//   instance.N.M where M is translate (x,y,z), rotate (degrees about x, then y, then z) or scale (x,y,z, or one number): moves
//                instance N from where its file or pose has it; see instance_edit.hpp. hidden (0 or 1): as in `hide`; mask:
//                kinds of rays that hit it
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "scene/instance_edit.hpp"
#include "scene/scene.hpp"
#include "view/camera_path.hpp"
#include "view/edit/texture_edit.hpp"
#include "view/view.hpp"

namespace clarity {

// One edit: "light.0", "off".
struct Word {
    std::string key, value;
};

// A view, the lights that are switched off in it, and what was done to the scene's instances.
struct EditedView {
    View view;                    // with all lights, including those that are off
    std::vector<bool> lights_on;  // one for each light; missing ones are on
    InstanceEdits instances;
    MapEdits maps{};
    CameraPath camera_path{};
    bool follows_path = false;  // the camera was not set after the path
};

// Whether `key` is an edit. Other keys belong to the settings table.
bool is_edit(const std::string& key);
// Applies an edit. Throws Error(usage), which says what was read and what is allowed.
void apply_edit(const Scene& scene, EditedView& edited, const std::string& key, const std::string& value);
// Returns the edits that turn `base` into `edited`. Numbers have all their digits. The camera is always included, or
// its path if it follows one.
std::vector<Word> edits_between(const Scene& scene, const EditedView& base, const EditedView& edited);
// Returns the view to trace: without the lights that are off.
View visible_view(const EditedView& edited);
// Puts the edits in force that the scene's files make. Throws Error(import_failed), which names the file and the line.
void apply_scene_edits(const Scene& scene, EditedView& edited);
// The scene at rest that the view is one of: with its instances moved and hidden, and its materials' textures.
Scene edited_scene(const Scene& scene, const EditedView& edited);
// A scene in which they are in force, for those who trace or describe it without a view. Shares all that is large.
Scene with_scene_edits(Scene scene);
// Returns what the scene's files, and then these edits, do to instances and textures. Edits of other kinds are skipped.
EditedView scene_edits(const Scene& scene, const std::vector<Word>& edits);
// Whether edited_scene() has anything to do.
inline bool changes_scene(const EditedView& edited) {
    return !edited.instances.empty() || !edited.maps.empty();
}

// Whether the scene can have a sky of that kind: pictures come from files.
bool is_possible_sky(const Scene& scene, rt_u32 kind);
// Another kind of sky, which looks like the one before as far as it can. Words do not use it: they say all that changes.
void choose_sky_kind(const Scene& scene, const View& view, rt_u32 kind, SkyValues& sky);

// A scene that is saved with its edits as a text scene (docs/scene_format.md).
struct SceneToSave {
    const Scene& imported;
    const std::vector<std::string>& files;  // that it was imported from
    const EditedView& edited;               // with the edits that the files make themselves
};
// Writes a .scene that shows the same: it loads the files, and makes the edits. If `path` is the only file and a .scene, it
// keeps its own text, and its edits, its surroundings and the camera that this function wrote are replaced. The file appears
// whole or not at all. Throws Error(usage) if the path does not end in .scene, and Error(failed).
void save_scene(const SceneToSave& scene, const std::string& path);
// The files of the pictures that edits give to materials.
std::vector<std::string> given_pictures(const Scene& scene, const MapEdits& maps);
// The folders besides that of `path` which a reader must allow (--search-path), because files lie there.
std::vector<std::string> folders_outside(const std::vector<std::string>& files, const std::string& path);

}  // namespace clarity
