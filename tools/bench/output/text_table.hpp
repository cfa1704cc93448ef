// text_table.hpp -- aligned columns for a terminal.
#pragma once
#include <string>
#include <vector>

namespace clarity::bench {

class TextTable {
 public:
    // The first `left` columns are text and aligned left; the others are numbers and aligned right.
    TextTable(std::vector<std::string> head, size_t left) : left_(left) { rows_.push_back(std::move(head)); }
    void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
    bool empty() const { return rows_.size() == 1; }
    // The table as text. Cells of text columns are cut to `cell` characters. Empty columns of numbers are left out.
    std::string text(size_t cell = 34) const;

 private:
    const size_t left_;
    std::vector<std::vector<std::string>> rows_;
};

// Three significant digits: 0.0123, 1.23, 12.3, 1234; "" for 0.
std::string short_number(double value);
std::string decimals(double value, int digits);
// A share of 1 as a number of hundredths: 0.125 is "12.5".
std::string percent(double share);

}  // namespace clarity::bench
