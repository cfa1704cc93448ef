// results.hpp -- marks in the forms that others read.
#pragma once
#include <string>
#include <vector>

#include "tools/lab/grade.hpp"

namespace clarity::lab {

// A page of text for a terminal.
std::string marks_text(const Lab& lab, const Marks& marks);
// Gradescope's results.json. marks: nullptr before grading has come to its end, so that a limit of time is no other score.
std::string gradescope_json(const Lab& lab, const Marks* marks);
// The line that Autolab reads last. marks: as above.
std::string autolab_line(const Marks* marks);
// Our own record of a submission, for `board`. digest: Grader::digest().
std::string record_json(const Lab& lab, const std::string& submission, const std::string& digest, const Marks& marks);
// Whether a file is a record of that digest.
bool record_fits(const std::string& path, const std::string& digest);

// One page with the marks of all submissions, the least work first.

// A row of the page, as a record has it (results.hpp).
struct BoardRow {
    std::string name;
    double work = 0, checks = 0, counts = 0, speed = 0,
           total = 0;   // work: by the reference's; 0: not known, because a hit is wrong
    unsigned rank = 0;  // from 1; 0: none
};

// The records NAME.json in a folder, ranked: what differs by at most 2 % from the best of a rank shares it. Throws Error(usage)
// if there is none.
std::vector<BoardRow> read_board(const std::string& folder);
// The page: HTML without scripts, nothing of which is loaded from elsewhere.
std::string board_html(const std::string& title, const std::vector<BoardRow>& rows);

}  // namespace clarity::lab
