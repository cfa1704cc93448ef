// board.hpp -- one page with the marks of all submissions, the least work first.
#pragma once
#include <string>
#include <vector>

namespace clarity::lab {

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
