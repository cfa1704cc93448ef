// rows.hpp -- rows of `clarity bench` and `clarity check`.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/progress.hpp"

namespace clarity::api {

// words: of the command line, behind `clarity`. row: gets each row, JSON in one line. Throws Error with the program's code and
// words, and Cancelled.
void give_rows(std::vector<std::string> words, const std::function<void(const std::string& json)>& row, Progress& progress);

}  // namespace clarity::api
