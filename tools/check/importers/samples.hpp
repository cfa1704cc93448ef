// samples.hpp -- the files on which an importer is tried, and what independent programs read from them; and their damaged
// copies.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rt_plugin.h"
#include "scene/vec.hpp"

namespace clarity::check {

// Damaged copies of a file, and files that are none. Made by formula: the same on every machine.
struct Mutant {
    std::string what;  // "byte 17 is 0xFF instead of 0x03"
    std::string bytes;
};

// `count` copies of a file, each damaged in one way: cut short, bytes replaced, a block left out, doubled or zeroed, a number
// of a text replaced by an impossible one. Before them come copies with impossible first numbers. seed: see seed.hpp.
std::vector<Mutant> mutants_of(const std::string& bytes, unsigned count, uint64_t seed);

// Content that no format has: one byte, zeros, random bytes, brackets without end, one endless line.
std::vector<Mutant> junk();

// What a file holds, in its own units and axes, as far as it is known.
struct Contents {
    std::optional<double> triangles, area, instances, materials;
    std::optional<double> flat;                // instances whose transform is singular; none are expected otherwise
    std::optional<double> volume;              // positive where closed surfaces wind counter-clockwise, seen from outside
    std::optional<std::array<Vec, 2>> bounds;  // lo and hi
    // A corner of a triangle, and what is known there. Where several corners are at one place, one of them must have it all.
    struct Corner {
        Vec at{};
        std::optional<Vec> normal;  // for shading
        std::optional<Vec> facing;  // of the triangle, as it winds
        std::optional<std::array<double, 2>> uv;
    };
    std::vector<Corner> corners;
    std::map<std::string, double> material_triangles;  // by the material's name
    // One of these must have it all.
    struct Placed {
        std::string name;
        std::optional<double> triangles;
        std::optional<std::array<Vec, 2>> bounds;
    };
    std::vector<Placed> placed;
    std::string keys;         // those that are there: "triangles, area"
    bool undeformed = false;  // it is of meshes as they are stored, without what skins and morphs do
};

// Files of the importer's extensions among these files and in these folders, the smallest first.
std::vector<std::string> samples_among(const rt_importer& importer, const std::vector<std::string>& files_and_folders);

// The truth about a file, if there is one: from FILE.json beside it, or from a .json file in `folder` whose field `file` is the
// file's folder and name. The keys are in the object itself, or in `truth`, `static` or both; each may be left out. Throws
// Error(usage) "FILE.json: why" if they cannot be read.
std::optional<Contents> truth_of(const std::string& file, const std::string& folder);

// Damaged copies of samples, as files in a folder. They are written before the sandbox closes.
struct HostileFile {
    std::string path, what;  // what: "box.obj, but byte 17 is 0xFF instead of 0x03"
};
// Writes the files. count: how many damaged copies of all samples together. Throws Error(failed).
std::vector<HostileFile> write_hostile_files(const rt_importer& importer, const std::vector<std::string>& samples,
                                             const std::string& folder, unsigned count, uint64_t seed);

}  // namespace clarity::check
