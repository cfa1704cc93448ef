// ascii.hpp -- the text form of FBX files.
#pragma once
#include "document.hpp"

namespace fbx_import {

// `Name: value, value {` children `}`. Values are numbers, words or "texts"; they end at the end of the line unless a comma
// stands at the end of it or at the start of the next one. `;` begins a comment. Measured from max2009_cube_anim_5800_ascii
// (commas), maya_cube_7400_ascii and blender_279_default_6100_ascii.
class AsciiReader {
 public:
    explicit AsciiReader(Document& document)
        : document_(document), at_(document.bytes_.data()), end_(at_ + document.bytes_.size()) {}
    void read();

 private:
    void read_nodes(uint32_t parent, int depth);
    void skip_space();
    void skip_values();
    [[noreturn]] void fail(const char* where, const std::string& what) const;
    Document& document_;
    const char *at_, *const end_;
};

// Reads one number and moves `at` behind it. "nan", "inf" and "-1.#IND" are numbers here. Returns false if there is none.
bool read_number(const char*& at, const char* end, double& number);
bool read_number(const char*& at, const char* end, int64_t& number);  // without a fraction or exponent

// The text with &quot; &lf; &cr; and &amp; replaced. Source: measured from max_quote_6100_ascii.
std::string without_entities(std::string_view text);

}  // namespace fbx_import
