// text_lines.hpp -- the lines of text files as all programs write them: a byte order mark may come first, and lines end with
// LF, CR LF or CR (Rhino and old Macintosh programs). For importers.
#pragma once
#include <cstring>
#include <string>
#include <string_view>

namespace importers {

constexpr bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}

// The text behind UTF-8's byte order mark, if there is one.
constexpr std::string_view without_mark(std::string_view text) {
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    return text.substr(0, mark.size()) == mark ? text.substr(mark.size()) : text;
}

// Cuts a text into lines. The text must outlive it. For readers that look at single characters instead, is_line_end() and
// without_mark() are enough.
class Lines {
 public:
    explicit Lines(std::string_view text)
        : at_(without_mark(text).data()), end_(text.data() + text.size()), first_(at_), lf_(at_), cr_(at_) {
        lf_ = find('\n');
        cr_ = find('\r');
        cr_alone_ = cr_ < lf_ && !is_pair();
    }

    // Gives the next line without its end. Returns false at the end of the text.
    bool next(std::string_view& line) {
        if (at_ == end_) return false;
        // Where the next LF and CR are is remembered, so that a text without one of them is searched for it only once.
        if (lf_ < at_) lf_ = find('\n');
        if (cr_ < at_) cr_ = find('\r');
        const char* const stop = lf_ < cr_ ? lf_ : cr_;
        line = {at_, static_cast<size_t>(stop - at_)};
        behind_cr_ = stop < end_ && stop == cr_ ? cr_ + 1 : nullptr;
        at_ = stop == end_ ? end_ : stop + (is_pair() ? 2 : 1);
        ++number_;
        return true;
    }
    // Likewise, but a line that ends with a backslash goes on in the next one, with a blank in between. The line is valid until
    // the next call.
    bool next_joined(std::string_view& line) {
        if (!next(line)) return false;
        if (line.empty() || line.back() != '\\') return true;
        joined_.clear();
        do {
            const bool goes_on = !line.empty() && line.back() == '\\';
            joined_.append(goes_on ? line.substr(0, line.size() - 1) : line).append(goes_on ? " " : "");
            if (!goes_on) break;
        } while (next(line));
        line = joined_;
        return true;
    }

    // The number of the line that was given last, from 1.
    size_t number() const { return number_; }
    // What follows that line.
    std::string_view rest() const { return {at_, static_cast<size_t>(end_ - at_)}; }
    // Likewise for binary data behind a text: in a text whose first line ends with CR alone, a LF behind a CR is data.
    std::string_view data() const {
        const char* const at = cr_alone_ && behind_cr_ ? behind_cr_ : at_;
        return {at, static_cast<size_t>(end_ - at)};
    }
    // The share of the text that was given, 0..1.
    float fraction() const {
        return end_ == first_ ? 1.0f : static_cast<float>(at_ - first_) / static_cast<float>(end_ - first_);
    }

 private:
    const char* find(char c) const {
        const void* found = at_ < end_ ? std::memchr(at_, c, static_cast<size_t>(end_ - at_)) : nullptr;
        return found ? static_cast<const char*>(found) : end_;
    }

    bool is_pair() const { return lf_ < end_ && lf_ == cr_ + 1; }

    const char *at_, *end_, *first_;
    const char *lf_, *cr_;             // the next ones; end_: there is none
    const char* behind_cr_ = nullptr;  // behind the CR that ended the last line; nullptr: none did
    bool cr_alone_ = false;
    size_t number_ = 0;
    std::string joined_;
};

}  // namespace importers
