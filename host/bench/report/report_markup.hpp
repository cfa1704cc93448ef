// report_markup.hpp -- text, numbers and tables as XHTML; the result is well-formed for any input.
#pragma once
#include <string>
#include <vector>

namespace clarity::bench {

// Escapes text for element content and for attribute values in double quotes. Characters which XML forbids (control characters,
// bytes which are not UTF-8) become U+FFFD.
std::string escape_markup(const std::string& text);

// Three significant digits, with thin spaces between thousands: "0.0123", "1.23", "45 600". "0" for 0; "" for NaN and infinity.
std::string figure(double value);
// The same without trailing zeros: "0.1", "10".
std::string tick_figure(double value);
std::string percent_figure(double share);

// The escaped text as <p>TEXT</p>.
std::string paragraph(const std::string& text);

// A table. The first `left` columns are text. Cells are escaped. Empty columns are left out. A table without rows is empty.
class MarkupTable {
 public:
    MarkupTable(std::vector<std::string> head, size_t left) : head_(std::move(head)), left_(left) {}
    void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
    std::string markup() const;

 private:
    const std::vector<std::string> head_;
    const size_t left_;
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace clarity::bench
