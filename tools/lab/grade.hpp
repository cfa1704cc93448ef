// grade.hpp -- marks a submission of a lab. Students run the same code, with the public cases and without the reference.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "plugin/registry.hpp"
#include "tools/lab/build.hpp"
#include "tools/lab/lab.hpp"
#include "tools/lab/measure.hpp"

namespace clarity::lab {

// One row of what a student reads.
struct Line {
    std::string section;  // "build", "checks", "counts" or "speed"
    std::string name;     // "hits.random", "city"
    double points = 0, most = 0;
    std::string tried, found;
    std::string alone;  // a command that shows it alone; "": there is none
    bool hidden = false;
};

struct Marks {
    std::vector<Line> lines;
    double work = 0;   // a ray, by that of the reference: the geometric mean of all cases; 0: not known
    double speed = 0;  // T_ref / T, in the same way
    std::string sandbox;
    double of(const std::string& section) const;  // points
    double total() const;
};

struct GradeOptions {
    std::string device;
    std::string sdk;                  // the folder that Clarity is installed in
    std::string work;                 // a folder for builds, which later submissions use again
    std::vector<std::string> tools;   // folders that compilers may read, besides those that are found
    std::vector<std::string> closed;  // and of which they read nothing: submissions
    bool times = true;
    std::vector<std::string> only;  // lines, by name; empty: all
};

class Grader {
 public:
    // Builds the reference and takes its figures once. Throws Error if that fails: it is the teacher's fault.
    Grader(Lab lab, const PluginRegistry& plugins, GradeOptions options, Progress& progress);
    Marks grade(const std::string& submission, Progress& progress);
    // The cases with what is known of the reference; the handout holds those of the public ones.
    std::vector<Case> known_cases(Progress& progress);
    // Tells what is marked, and how: the files that were handed in, and the lab. Not the machine.
    std::string digest(const std::string& submission) const;
    const Lab& lab() const { return lab_; }

 private:
    // What is made of a submission. table: the same kernels with the teacher's host code, where students write a builder beside
    // kernels; "": not needed.
    struct Libraries {
        std::string own, table;
    };
    Libraries build(const std::string& submission, Progress& progress) const;
    // Returns whether all hits that were checked are right.
    bool mark_checks(const Libraries& libraries, Marks& marks, Progress& progress);
    void mark_cases(const Libraries& libraries, Marks& marks, Progress& progress);
    MeasureJob job_for(const Libraries& libraries) const;
    ClosedBuilder closed(const Libraries& libraries) const;
    bool is_wanted(const std::string& name) const;

    const Lab lab_;
    const GradeOptions options_;
    const Sandbox sandbox_;
    const BuildTools tools_;
    std::string layout_, reference_;  // libraries
    std::vector<MadeCase> cases_;
    std::string lab_digest_;  // of the lab's own files
};

// Points of counts. ratio: work by that of the reference; on a log scale from `none` to `full`.
double counts_points(const Lab& lab, double ratio);

}  // namespace clarity::lab
