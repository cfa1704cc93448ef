// lab.hpp -- a lab: an assignment of a course, which is a folder. What students get, what they hand in, and how it is marked.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "rt_types.h"
#include "scene/scene.hpp"

namespace clarity::lab {

// A scene and rays, made by a generator: the same on every machine.
struct Case {
    std::string name, scene;  // scene: a row of kGenerators; of models of surfaces one of kLights
    unsigned triangles = 0, rays = 0;
    uint64_t seed = 0;
    unsigned poses = 1;  // more than 1: each pose is a mesh, with as many of the rays
    bool hidden = false;
    // Of models of surfaces: a material.
    std::array<float, 3> color{1, 1, 1};
    std::vector<std::pair<std::string, std::array<double, 3>>> keys;  // the others have their defaults
    // Of the reference solution, where students have no reference: its work, 0: not known; what is right, of models of surfaces
    // the light that is sent back.
    double reference = 0;
    std::vector<double> truth;
    CLARITY_MEMBERS(name, scene, triangles, rays, seed, poses, hidden, color, keys, reference, truth);
};

struct Lab {
    std::string folder, title;
    // The plugin. layout: of a builder of trees, the structure that packs and traces them; "": the plugin has slots and kernels
    // of its own. is_surface: the plugin is a model of surfaces.
    std::string id, layout;
    bool is_surface = false;
    struct File {
        std::string name;
        uint64_t most_bytes = 0;
        bool is_kernel() const;  // not C++: OpenCL C, which is compiled into the teacher's kernels
    };
    std::vector<File> files;             // that students hand in
    std::vector<std::string> shared;     // files of the folder `shared` beside the labs, which belong to the handout
    std::vector<std::string> forbidden;  // what must not stand in those that are kernels
    std::vector<std::string> checks;     // of `clarity check`, or their beginnings
    int lanes = 1;                       // of all kernels: counts do not depend on the machine
    double points_checks = 50, points_answers = 0, points_counts = 35, points_speed = 15;
    // Counts: all points at `full` times the work of the reference, none at `none` times.
    double full = 1.1, none = 8;
    double compile_s = 120, build_s = 2;  // for the compiler, of the clock; for one build of a structure, of the processor
    uint64_t memory_bytes = uint64_t(1) << 30;
    std::string visibility = "visible", hidden_visibility = "visible";  // of lines, in Gradescope's words
    std::vector<Case> cases;

    // Whether students write a builder, which only workers behind closed doors open.
    bool has_builder() const;
    // The folder from which a plugin is built, but for the files of students.
    std::string handout() const;
    // All files of the handout, with the shared ones. Throws Error(usage) if one of these is nowhere.
    std::vector<std::string> given() const;
    std::string reference() const;  // "": there is none, as in what students have
};

// Reads FOLDER/lab.json, and FOLDER/hidden/cases.json if it is there and wanted. Throws Error(usage), which names file and key.
Lab read_lab(const std::string& folder, bool with_hidden);

struct MadeCase {
    Scene scene;
    std::vector<rt_ray> rays;
};
// Throws Error(usage) for an unknown generator.
MadeCase make_case(const Case& of);

// clarity lab handout: copies what students get into a new folder. known: the public cases with what is known of the reference.
void write_handout(const Lab& lab, const std::string& folder, const std::vector<Case>& known);

// The folder of the labs that are installed with the program.
std::string installed_labs();
// clarity lab new: a copy of an installed lab, with another id.
void copy_lab(const std::string& from, const std::string& to);

}  // namespace clarity::lab
