// xml_tags.hpp -- the tags of an XML text, one after the other. It need not be well-formed: assimp refuses what is not.
#pragma once
#include <algorithm>
#include <string_view>

namespace assimp_import {

inline constexpr std::string_view kXmlBlanks = " \t\r\n";

class XmlTags {
 public:
    explicit XmlTags(std::string_view text) : text_(text) {}

    // Goes to the next tag, comment, CDATA section or declaration. False: there is none.
    bool next() {
        const size_t at = text_.find('<', behind_);
        if (at == text_.npos) return false;
        before = text_.substr(behind_, at - behind_);
        behind_ = text_.substr(at, 4) == "<!--"        ? behind("-->", at)
                  : text_.substr(at, 9) == "<![CDATA[" ? behind("]]>", at)
                  : text_.substr(at, 2) == "<?"        ? behind("?>", at)
                                                       : end_of_tag(at);
        tag = text_.substr(at, behind_ - at);
        is_tag = tag.substr(0, 2) != "<!" && tag.substr(0, 2) != "<?";
        ends = tag.substr(0, 2) == "</";
        is_empty = tag.size() > 1 && tag[tag.size() - 2] == '/';
        name = tag.substr(ends ? 2 : 1, tag.find_first_of(" \t\r\n/>", 2) - (ends ? 2 : 1));
        return true;
    }

    std::string_view before;     // the text between the last one and this one
    std::string_view tag, name;  // all of it, from '<' to '>', and the element's name
    bool is_tag = false;         // no comment or the like
    bool ends = false;           // </name>
    bool is_empty = false;       // <name/>

 private:
    size_t behind(std::string_view end, size_t at) const {
        const size_t found = text_.find(end, at);
        return found == text_.npos ? text_.size() : found + end.size();
    }
    // A '>' in quotes does not end a tag.
    size_t end_of_tag(size_t at) const {
        while ((at = text_.find_first_of(">\"'", at)) != text_.npos && text_[at] != '>') {
            at = text_.find(text_[at], at + 1);
            if (at == text_.npos) break;
            ++at;
        }
        return at == text_.npos ? text_.size() : at + 1;
    }
    const std::string_view text_;
    size_t behind_ = 0;
};

// The value of an attribute of a tag; empty if it has none.
inline std::string_view xml_attribute(std::string_view tag, std::string_view name) {
    for (size_t at = 0; (at = tag.find(name, at)) != tag.npos; ++at) {
        const size_t equals = tag.find_first_not_of(kXmlBlanks, at + name.size());
        if (at == 0 || kXmlBlanks.find(tag[at - 1]) == kXmlBlanks.npos || equals == tag.npos || tag[equals] != '=') continue;
        const size_t quote = tag.find_first_of("\"'", equals);
        return quote == tag.npos ? tag.substr(tag.size()) : tag.substr(quote + 1, tag.find(tag[quote], quote + 1) - quote - 1);
    }
    return {};
}

}  // namespace assimp_import
