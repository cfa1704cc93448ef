// report_markup.hpp -- text, numbers and tables as XHTML: what comes out is well-formed whatever goes in.
#pragma once
#include <string>
#include <vector>

namespace clarity::bench {

// Text for element content and attribute values in double quotes. What no XML may hold (control characters, bytes that are not
// UTF-8) becomes U+FFFD.
std::string escape_markup(const std::string& text);

// Three significant digits with thin spaces between thousands: "0.0123", "1.23", "45 600"; "0" for 0, "" for what is no number.
std::string figure(double value);
// The same without zeros at the end: "0.1", "10".
std::string tick_figure(double value);
std::string percent_figure(double share);

// <p>TEXT</p>, escaped.
std::string paragraph(const std::string& text);

// The first `left` columns are text. Cells are escaped; columns in which nothing stands are left out. Empty without rows.
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
