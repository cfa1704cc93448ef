// xml_reader.hpp -- reads an XML text tag by tag, and says where it is damaged.
#pragma once
#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "xml_check.hpp"

namespace assimp_import {

inline constexpr size_t kMostLevels = 1000;  // assimp follows them by recursion

struct Damage : std::runtime_error {
    using std::runtime_error::runtime_error;
};

inline bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}
inline bool is_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == ':' || c == '-' ||
           c == '.' || (c & 0x80);
}

// Reads a text tag by tag.
class Reader {
 public:
    struct Handlers {
        // element: the name as it stands in the tag. All attributes of a tag come with the same address.
        std::function<void(std::string_view element, std::string_view name, std::string_view value)> attribute;
        std::function<void(std::string_view element, std::string_view text)> text;  // behind a tag within the element
    };
    Reader(std::string_view text, Handlers handlers) : text_(text), handlers_(std::move(handlers)) {}

    void run() {
        for (at_ = 0; at_ < text_.size(); ++at_) {
            if (static_cast<unsigned char>(text_[at_]) < ' ' && !is_blank(text_[at_])) fail("text: XML has no control bytes");
        }
        at_ = 0;
        bool has_root = false;
        for (;;) {
            const size_t first = at_;
            while (at_ < text_.size() && text_[at_] != '<') ++at_;
            if (handlers_.text && !open_.empty()) handlers_.text(open_.back().name, text_.substr(first, at_ - first));
            if (at_ == text_.size()) break;
            if (skip("<!--", "-->") || skip("<![CDATA[", "]]>") || declaration() || skip("<?", "?>")) continue;
            if (starts("<!")) {
                doctype();
            } else {
                tag();
                has_root = true;
            }
        }
        if (!open_.empty())
            fail(in_quotes("</" + std::string(open_.back().name) + ">") + ", which ends the element of line " +
                 line(open_.back().at));
        if (!has_root) fail("an element of XML");
    }

    [[noreturn]] void fail(const std::string& expected) const {
        size_t end = at_;
        while (end < text_.size() && end - at_ < 24 && text_[end] != '\n' && !(end > at_ && is_blank(text_[end])) &&
               !(end > at_ && text_[end - 1] == '>'))
            ++end;
        fail_at(at_, at_ == text_.size() ? "the end of the file" : in_quotes(text_.substr(at_, end - at_)), expected);
    }
    [[noreturn]] void fail_at(size_t at, const std::string& found, const std::string& expected) const {
        const size_t line_first = text_.substr(0, at).rfind('\n') + 1;  // npos + 1 is 0
        throw Damage("line " + line(at) + ", column " + std::to_string(at - line_first + 1) + ": found " + found +
                     ", expected " + expected);
    }
    size_t position(std::string_view part) const { return size_t(part.data() - text_.data()); }

 private:
    struct Open {
        std::string_view name;
        size_t at;
    };
    bool starts(std::string_view word) const { return text_.substr(at_, word.size()) == word; }
    char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    std::string line(size_t at) const {
        return std::to_string(std::count(text_.begin(), text_.begin() + std::ptrdiff_t(at), '\n') + 1);
    }
    void skip_blanks() {
        while (is_blank(peek())) ++at_;
    }
    bool skip(std::string_view begin, std::string_view end) {
        if (!starts(begin)) return false;
        const size_t found = text_.find(end, at_ + begin.size());
        if (found == text_.npos) fail("'" + std::string(end) + "' behind it");
        at_ = found + end.size();
        return true;
    }
    // `<?xml version="1.0"?>`
    bool declaration() {
        if (!starts("<?xml ")) return false;
        for (at_ += 5;;) {
            const bool has_blank = is_blank(peek());
            skip_blanks();
            if (starts("?>")) break;
            if (!has_blank) fail("a space or '?>'");
            attribute("?xml");
        }
        at_ += 2;
        return true;
    }
    void doctype() {
        if (!starts("<!DOCTYPE")) fail("'<!--', '<![CDATA[' or '<!DOCTYPE'");
        int depth = 0;
        for (; at_ < text_.size(); ++at_) {
            depth += text_[at_] == '<' ? 1 : text_[at_] == '>' ? -1 : 0;
            if (depth > 0) continue;
            ++at_;
            return;
        }
        fail("'>'");
    }
    std::string_view name(const char* expected) {
        const size_t first = at_;
        if ((peek() >= '0' && peek() <= '9') || peek() == '-' || peek() == '.') fail(expected);
        while (at_ < text_.size() && is_name(text_[at_])) ++at_;
        if (at_ == first) fail(expected);
        return text_.substr(first, at_ - first);
    }

    void tag() {
        const size_t first = at_++;
        if (peek() == '/') {
            ++at_;
            const std::string_view closed = name("the name of an element");
            if (open_.empty() || open_.back().name != closed) {
                at_ = first;
                if (open_.empty()) fail("no end of an element, because none is open");
                fail(in_quotes("</" + std::string(open_.back().name) + ">") + ", which ends the element of line " +
                     line(open_.back().at));
            }
            open_.pop_back();
            skip_blanks();
            if (peek() != '>') fail("'>'");
            ++at_;
            return;
        }
        const std::string_view element = name("the name of an element");
        for (;;) {
            const bool has_blank = is_blank(peek());
            skip_blanks();
            if (starts("/>")) {
                at_ += 2;
                return;
            }
            if (peek() == '>') break;
            if (!has_blank) fail("a space, '>' or '/>'");
            attribute(element);
        }
        ++at_;
        if (open_.size() == kMostLevels) fail("at most 1000 elements inside each other");
        open_.push_back({element, first});
    }
    void attribute(std::string_view element) {
        const std::string_view key = name("an attribute, '>' or '/>'");
        skip_blanks();
        if (peek() != '=') fail("'=' behind the attribute " + in_quotes(key));
        ++at_;
        skip_blanks();
        const char quote = peek();
        if (quote != '"' && quote != '\'') fail("the value of " + in_quotes(key) + " in quotes");
        const size_t end = text_.find(quote, at_ + 1), next = text_.find('<', at_ + 1);
        if (end == text_.npos || next < end)
            fail("a second " + std::string(1, quote) + " behind the value of " + in_quotes(key));
        if (handlers_.attribute) handlers_.attribute(element, key, text_.substr(at_ + 1, end - at_ - 1));
        at_ = end + 1;
    }

    std::string_view text_;
    const Handlers handlers_;
    size_t at_ = 0;
    std::vector<Open> open_;
};

// Runs the check of a text. Returns what it threw as Damage, or an empty string. Texts in UTF-16 are not checked.
template <class Check>
std::string damage_of(std::string_view text, const Check& check) {
    if (text.substr(0, 2) == "\xFE\xFF" || text.substr(0, 2) == "\xFF\xFE") return {};
    try {
        check();
    } catch (const Damage& damage) {
        return damage.what();
    }
    return {};
}

}  // namespace assimp_import
