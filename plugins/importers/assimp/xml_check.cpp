#include "xml_check.hpp"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <set>
#include <stdexcept>
#include <vector>

namespace assimp_import {
namespace {

constexpr size_t kMostLevels = 1000;  // assimp follows them by recursion

struct Damage : std::runtime_error {
    using std::runtime_error::runtime_error;
};

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}
bool is_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == ':' || c == '-' ||
           c == '.' || (c & 0x80);
}

// Reads a text tag by tag.
class Reader {
 public:
    struct Handlers {
        std::function<void(std::string_view element, std::string_view name, std::string_view value)> attribute;
        std::function<void(std::string_view element, std::string_view text)> text;
    };
    Reader(std::string_view text, Handlers handlers) : text_(text), handlers_(std::move(handlers)) {}

    void run() {
        bool has_root = false;
        for (;;) {
            const size_t first = at_;
            while (at_ < text_.size() && text_[at_] != '<') ++at_;
            if (handlers_.text && !open_.empty()) handlers_.text(open_.back().name, text_.substr(first, at_ - first));
            if (at_ == text_.size()) break;
            if (skip("<!--", "-->") || skip("<![CDATA[", "]]>") || skip("<?", "?>")) continue;
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
    void doctype() {
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

// Calls body for each word.
template <class Body>
void for_words(std::string_view text, const Body& body) {
    for (size_t at = 0; at < text.size();) {
        while (at < text.size() && is_blank(text[at])) ++at;
        const size_t first = at;
        while (at < text.size() && !is_blank(text[at])) ++at;
        if (at > first) body(text.substr(first, at - first));
    }
}

std::string caught(const std::function<void()>& check) {
    try {
        check();
    } catch (const Damage& damage) {
        return damage.what();
    }
    return {};
}

bool is_number(std::string_view word) {
    const std::string text(word);
    char* end = nullptr;
    std::strtod(text.c_str(), &end);
    return end == text.c_str() + text.size();
}

bool is_whole(std::string_view word) {
    if (!word.empty() && word[0] == '-') word.remove_prefix(1);
    return !word.empty() && word.find_first_not_of("0123456789") == word.npos && word.size() < 11;
}

}  // namespace

std::string in_quotes(std::string_view text) {
    std::string out = "'";
    for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (text.size() > 60 ? "...'" : "'");
}

std::string xml_damage(std::string_view text) {
    return caught([&] {
        if (text.substr(0, 2) == "\xFE\xFF" || text.substr(0, 2) == "\xFF\xFE") return;  // UTF-16
        Reader(text, {}).run();
    });
}

std::string collada_damage(std::string_view text) {
    std::set<std::string_view> ids;
    std::vector<std::string_view> references;
    std::string_view count;  // of the array that begins
    const Reader* place = nullptr;
    const auto attribute = [&](std::string_view element, std::string_view name, std::string_view value) {
        if (name == "id") ids.insert(value);
        if ((name == "url" || name == "source" || name == "target") && value.substr(0, 1) == "#" &&
            element.substr(0, 3) != "tec")
            references.push_back(value);
        if (name == "count" && element == "float_array") count = value;
        if ((name == "count" || name == "stride" || name == "offset") && !is_whole(value))
            place->fail_at(place->position(value), in_quotes(value),
                           "a whole number as " + in_quotes(name) + " of <" + std::string(element) + ">");
    };
    const auto content = [&](std::string_view element, std::string_view words) {
        const bool is_floats = element == "float_array" || element == "translate" || element == "scale" ||
                               element == "rotate" || element == "matrix" || element == "color" || element == "float";
        const bool is_indices = element == "p" || element == "vcount" || element == "h";
        if (!is_floats && !is_indices) return;
        size_t found = 0;
        for_words(words, [&](std::string_view word) {
            ++found;
            if (!(is_floats ? is_number(word) : is_whole(word)))
                place->fail_at(place->position(word), in_quotes(word), is_floats ? "a number" : "an index");
        });
        if (element == "float_array" && !count.empty() && std::to_string(found) != count)
            place->fail_at(place->position(words), std::to_string(found) + " numbers in <float_array>",
                           std::string(count) + ", its 'count'");
        count = {};
    };
    const std::string damage = caught([&] {
        Reader reader(text, {attribute, content});
        place = &reader;
        reader.run();
        for (const std::string_view reference : references) {
            if (!ids.count(reference.substr(1)))
                reader.fail_at(reader.position(reference), in_quotes(reference), "the 'id' of an element of this file");
        }
    });
    return damage;
}

}  // namespace assimp_import
