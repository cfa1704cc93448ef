// measure.hpp -- what a structure costs on the cases of a lab: wrong hits, work a ray, and times in turns with the reference.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "import/wire.hpp"
#include "structures/accel_build.hpp"
#include "tools/lab/lab.hpp"
#include "worker/job.hpp"

namespace clarity::lab {

struct MeasureJob {
    std::string library;                // of the student; of kernels alone, since `closed` is empty
    std::vector<ClosedBuilder> closed;  // of a builder of trees; none or one
    std::string reference, layout;      // libraries; "": there is none
    std::string device;
    int lanes = 1;
    bool times = false;
    double limit_s = 10;  // of a step
    std::vector<import::SentScene> scenes;
    std::vector<std::vector<rt_ray>> rays;  // of each scene
    std::vector<unsigned> poses;
    std::vector<Case> materials;  // of a model of surfaces, in the place of scenes
    CLARITY_MEMBERS(library, closed, reference, layout, device, lanes, times, limit_s, scenes, rays, poses, materials);
};

// What a ray costs on the average of a case, counted by the host.
struct RayCosts {
    double nodes = 0, boxes = 0, tests = 0;
    double node_bytes = 0;  // of an element of the structure's first slot
    double following = 0;   // scenes that move: what builds and refits of all poses cost, by the number of rays
    double fresh = 0;       // the share of all nodes that are new in their pose
};

// Work a ray that is graded, in tests of a triangle. One place, for all labs.
double work_of(const RayCosts& costs);

// Which kind of thing is wrong: of a hidden case, students learn this and no more (grade.cpp).
enum class Wrong : uint8_t {
    nothing,
    nearest_hits,
    any_hits,
    build,
    kernels,
    counts,
    // Of models of surfaces.
    numbers,
    weights,
    density,
    eval_light,
    mean,
    never_drawn,
    // Of the process.
    crash,
    exit,
    endless,
    memory,
    state,
    other
};
// The kind of an error; those of no kind happened at a stage, of which `otherwise` is the kind.
Wrong wrong_of(Failure failure, Wrong otherwise);

struct CaseFigures {
    std::string wrong;                    // what is wrong; "": every hit is right
    Wrong kind = Wrong::nothing;          // of it
    std::string found;                    // what the work is of, for people
    std::vector<double> truth;            // of the reference: Case::truth
    double work = 0, reference_work = 0;  // 0: no reference
    double ms = 0, reference_ms = 0;
    bool steady = true;  // of the times: no row was refused
};

// Runs a job in a worker. The cases after the one in which the worker died have the same `wrong`. Throws Cancelled.
std::vector<CaseFigures> measure(const MeasureJob& job, Progress& progress);

extern const worker::JobKind kMeasureJob;

}  // namespace clarity::lab
