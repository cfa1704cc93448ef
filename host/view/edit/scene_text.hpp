// scene_text.hpp -- a scene with its edits as a text scene (docs/scene_format.md).
#pragma once
#include <string>
#include <vector>

#include "view/edit/edit.hpp"

namespace clarity {

// What is saved.
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
