// samples.hpp -- the files on which an importer is tried, and what independent programs read from them.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "check/importers/mutants.hpp"
#include "rt_plugin.h"

namespace clarity::check {

// What a file holds, in its own units and axes.
struct Contents {
    double triangles = 0, area = 0;
    double lo[3], hi[3];      // bounding box
    bool undeformed = false;  // it is of meshes as they are stored, without what skins and morphs do
};

// Files of the importer's extensions among these files and in these folders, the smallest first.
std::vector<std::string> samples_among(const rt_importer& importer, const std::vector<std::string>& files_and_folders);

// The truth about a file, if there is one: from FILE.json beside it, or from a .json file in `folder` whose field `file` is the
// file's folder and name. The numbers are in the object itself, or in `truth`, `static` or both. Throws Error(usage)
// "FILE.json: why" if they cannot be read.
std::optional<Contents> truth_of(const std::string& file, const std::string& folder);

// Damaged copies of samples, as files in a folder. They are written before the sandbox closes.
struct HostileFile {
    std::string path, what;  // what: "box.obj, but byte 17 is 0xFF instead of 0x03"
};
// Writes the files. count: how many damaged copies of all samples together. Throws Error(failed).
std::vector<HostileFile> write_hostile_files(const rt_importer& importer, const std::vector<std::string>& samples,
                                             const std::string& folder, unsigned count);

}  // namespace clarity::check
