#include "bench/report/xml_check.hpp"

#include <cctype>
#include <cstring>
#include <set>
#include <vector>

namespace clarity::test {
namespace {

class Checker {
 public:
    explicit Checker(const std::string& text) : text_(text) {}

    std::string run() {
        if (starts("<!DOCTYPE html>")) at_ += std::strlen("<!DOCTYPE html>");
        size_t roots = 0;
        while (at_ < text_.size()) {
            if (text_[at_] == '<') {
                if (open_.empty() && text_[at_ + 1] != '/') ++roots;
                if (!tag()) return error_ + " at byte " + std::to_string(at_) + ": " + text_.substr(at_, 60);
            } else if (!character(open_.empty())) {
                return error_ + " at byte " + std::to_string(at_) + ": " + text_.substr(at_, 60);
            }
        }
        if (!open_.empty()) return "<" + open_.back() + "> is never closed";
        return roots == 1 ? "" : std::to_string(roots) + " roots";
    }

 private:
    bool starts(const char* word) const { return text_.compare(at_, std::strlen(word), word) == 0; }
    bool fail(const std::string& why) {
        error_ = why;
        return false;
    }

    bool character(bool only_space) {
        const unsigned char c = static_cast<unsigned char>(text_[at_]);
        if (only_space && !std::isspace(c)) return fail("text outside the root");
        if (c < 0x20 && c != '\n' && c != '\t') return fail("control character");
        if (c == '&') {
            for (const char* entity : {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"})
                if (starts(entity)) {
                    at_ += std::strlen(entity);
                    return true;
                }
            return fail("a bare &");
        }
        if (c < 0x80) {
            ++at_;
            return true;
        }
        const size_t more = c >= 0xf0 && c < 0xf5 ? 3 : c >= 0xe0 ? 2 : c >= 0xc2 && c < 0xe0 ? 1 : 0;
        if (more == 0 || c >= 0xf5) return fail("not UTF-8");
        for (size_t i = 1; i <= more; ++i)
            if (at_ + i >= text_.size() || (static_cast<unsigned char>(text_[at_ + i]) & 0xc0) != 0x80)
                return fail("not UTF-8");
        at_ += more + 1;
        return true;
    }

    std::string name() {
        const size_t first = at_;
        while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || std::strchr("-_:", text_[at_])))
            ++at_;
        return text_.substr(first, at_ - first);
    }

    bool tag() {
        ++at_;
        const bool closes = starts("/");
        at_ += closes;
        const std::string element = name();
        if (element.empty()) return fail("no name after <");
        if (closes) {
            if (open_.empty() || open_.back() != element || !starts(">")) return fail("</" + element + "> closes nothing");
            open_.pop_back();
            ++at_;
            return true;
        }
        std::set<std::string> seen;
        for (;;) {
            while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
            if (starts("/>")) {
                at_ += 2;
                return true;
            }
            if (starts(">")) {
                ++at_;
                open_.push_back(element);
                return true;
            }
            const std::string attribute = name();
            if (attribute.empty() || !seen.insert(attribute).second)
                return fail("a bad or repeated attribute of <" + element + ">");
            if (!starts("=\"")) return fail(attribute + " without a quoted value");
            for (at_ += 2; !starts("\"");) {
                if (at_ >= text_.size() || text_[at_] == '<') return fail("the value of " + attribute + " does not end");
                if (!character(false)) return false;
            }
            ++at_;
        }
    }

    const std::string& text_;
    size_t at_ = 0;
    std::vector<std::string> open_;
    std::string error_;
};

}  // namespace

std::string xml_error(const std::string& text) {
    return Checker(text).run();
}

}  // namespace clarity::test
