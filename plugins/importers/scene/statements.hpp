// statements.hpp -- the table of the text format's statements.
#pragma once
#include <string_view>
#include <vector>

#include "document.hpp"
#include "statement.hpp"

namespace scene_format {

// A statement: its first word, and the function that reads the rest of it into the document. The function throws StatementError
// if it cannot; the document may then only be used to find further errors.
struct StatementRow {
    std::string_view word;
    void (*read)(Statement&, Document&, Diagnostics&);
};
const std::vector<StatementRow>& statements();

}  // namespace scene_format
