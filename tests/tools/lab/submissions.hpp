// submissions.hpp -- grades submissions of a lab, and compares their marks with those that were written down before.
#pragma once
#include <string>
#include <utility>
#include <vector>

inline constexpr const char* kStarter = "starter";
// A submission is our solution with one edit. Its mark, of 100 without times: 50 of checks and 50 of counts.
struct Submission {
    const char* name;
    const char* from;  // the first place of this text ...
    const char* to;    // ... becomes this. kStarter: the file is that of the handout
    double least, most;
    const char* found;  // stands in what some line found; "": anything
    bool quick = false;
    std::vector<std::pair<const char*, const char*>> more = {};  // edits
};

// All submissions of a lab, which one run grades; in quick tests some. file: which they hand in.
void expect_marks(const std::string& folder, const std::string& file, const std::vector<Submission>& all);
