#include "collada_check.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <vector>

#include "content_checks.hpp"
#include "xml_tags.hpp"

namespace assimp_import {
namespace {

size_t words_in(std::string_view text) {
    size_t count = 0;
    for (size_t at = 0; (at = text.find_first_not_of(kXmlBlanks, at)) != text.npos; ++count) {
        at = std::min(text.find_first_of(kXmlBlanks, at), text.size());
    }
    return count;
}

int64_t whole(std::string_view text, int64_t otherwise) {
    std::from_chars(text.data(), text.data() + text.size(), otherwise);
    return otherwise;
}

class Scan {
 public:
    explicit Scan(std::string_view text) : text_(text) {}

    std::string run() {
        for (XmlTags tags(text_); why_.empty() && tags.next();) {
            if (open_array_) open_array_->found += static_cast<int64_t>(words_in(tags.before));
            if (tags.is_tag) tag(tags);
        }
        for (const Accessor& accessor : accessors_) check(accessor);
        return why_;
    }

 private:
    struct Array {
        int64_t declared = 0, found = 0;  // numbers
    };
    struct Accessor {
        std::string_view tag;
        int64_t parameters = 0;
    };

    void tag(const XmlTags& found) {
        const std::string_view tag = found.tag, name = found.name;
        open_array_ = nullptr;
        if (found.ends) {
            depth_ -= depth_ > 0;
            in_accessor_ = in_accessor_ && name != "accessor";
            return;
        }
        if (!found.is_empty && ++depth_ > kMostLevels) fail(tag, "another level", "at most 1000 elements inside each other");
        if (name == "accessor") accessors_.push_back({tag, 0});
        if (name == "param" && in_accessor_) ++accessors_.back().parameters;
        if (name == "accessor") in_accessor_ = !found.is_empty;
        if (name.size() < 7 || name.substr(name.size() - 6) != "_array") return;
        const std::string_view count = xml_attribute(tag, "count");
        if (count.empty()) fail(tag, "<" + std::string(name) + "> without 'count'", "that attribute");
        open_array_ = &(arrays_[xml_attribute(tag, "id")] = {whole(count, 0), 0});
    }

    void check(const Accessor& accessor) {
        const std::string_view source = xml_attribute(accessor.tag, "source");
        const auto array = arrays_.find(source.substr(std::min<size_t>(1, source.size())));
        const auto number = [&](const char* name, int64_t otherwise) {
            return whole(xml_attribute(accessor.tag, name), otherwise);
        };
        const int64_t count = number("count", 0), stride = number("stride", 1), offset = number("offset", 0);
        if (array == arrays_.end() || count <= 0) return;
        const int64_t room = std::min(array->second.declared, array->second.found);
        const double last = double(offset) + double(stride) * double(count - 1) + double(accessor.parameters);
        if (offset >= 0 && stride >= 0 && last <= double(room)) return;
        fail(accessor.tag,
             "an <accessor> to " + std::to_string(count) + " elements of " + std::to_string(stride) +
                 " numbers from the number " + std::to_string(offset) + " on",
             "elements within the " + std::to_string(room) + " numbers of " + in_quotes(source));
    }

    // tag: the one that is wrong. Its name is the place. Only the first place counts.
    void fail(std::string_view tag, const std::string& found, const std::string& expected) {
        const std::string_view before = text_.substr(0, static_cast<size_t>(tag.data() - text_.data()) + 1);
        if (!why_.empty()) return;
        why_ = "line " + std::to_string(std::count(before.begin(), before.end(), '\n') + 1) + ", column " +
               std::to_string(before.size() - before.rfind('\n')) +  // npos is -1
               ": found " + found + ", expected " + expected;
    }

    static constexpr size_t kMostLevels = 1000;
    const std::string_view text_;
    std::map<std::string_view, Array> arrays_;  // by id
    std::vector<Accessor> accessors_;
    Array* open_array_ = nullptr;  // the one whose numbers follow
    bool in_accessor_ = false;
    size_t depth_ = 0;
    std::string why_;
};

}  // namespace

std::string crash_in_xml(std::string_view text) {
    const bool is_utf16 = text.substr(0, 2) == "\xFE\xFF" || text.substr(0, 2) == "\xFF\xFE";
    return is_utf16 ? std::string() : Scan(text).run();
}

}  // namespace assimp_import
