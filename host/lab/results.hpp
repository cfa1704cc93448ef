// results.hpp -- marks in the forms that others read.
#pragma once
#include <string>

#include "lab/grade.hpp"

namespace clarity::lab {

// A page of text for a terminal.
std::string marks_text(const Lab& lab, const Marks& marks);
// Gradescope's results.json. marks: nullptr before grading has come to its end, so that a limit of time is no other score.
std::string gradescope_json(const Lab& lab, const Marks* marks);
// The line that Autolab reads last. marks: as above.
std::string autolab_line(const Marks* marks);
// Our own record of a submission, for `board`.
std::string record_json(const Lab& lab, const std::string& submission, const Marks& marks);

}  // namespace clarity::lab
