// collada_check.cpp -- references, counts and numbers of COLLADA files (COLLADA 1.4.1 specification, Khronos Group, 2008).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

#include "xml_reader.hpp"

namespace assimp_import {
namespace {

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

bool is_number(std::string_view word) {
    const std::string text(word);
    char* end = nullptr;
    std::strtod(text.c_str(), &end);
    return end == text.c_str() + text.size() && text.find_first_of("xX") == text.npos;
}

bool is_whole(std::string_view word) {
    if (!word.empty() && word[0] == '-') word.remove_prefix(1);
    return !word.empty() && word.find_first_not_of("0123456789") == word.npos && word.size() < 11;
}

double whole(std::string_view word, double otherwise) {
    return is_whole(word) ? std::strtod(std::string(word).c_str(), nullptr) : otherwise;
}

const std::set<std::string_view> kWithoutText = {"geometry", "mesh", "source", "vertices", "polylist", "triangles", "accessor"};
const std::set<std::string_view> kSemantics = {
    "BINORMAL", "COLOR",        "CONTINUITY",   "IMAGE",        "INPUT",  "IN_TANGENT", "INTERPOLATION", "INV_BIND_MATRIX",
    "JOINT",    "LINEAR_STEPS", "MORPH_TARGET", "MORPH_WEIGHT", "NORMAL", "OUTPUT",     "OUT_TANGENT",   "POSITION",
    "TANGENT",  "TEXBINORMAL",  "TEXCOORD",     "TEXTANGENT",   "UV",     "VERTEX",     "WEIGHT"};

class Collada {
 public:
    Collada(std::string_view text, bool refused)
        : refused_(refused),
          reader_(text, {[this](auto element, auto name, auto value) { attribute(element, name, value); },
                         [this](auto element, auto words) { content(element, words); }}) {}

    void check() {
        reader_.run();
        for (const Tag& tag : accessors_) check_accessor(tag);
        if (!refused_) return;
        for (const std::string_view reference : references_) {
            if (!ids_.count(reference.substr(1))) fail(reference, in_quotes(reference), "the 'id' of an element of this file");
        }
        for (const std::string_view index : largest_indices_) {
            if (whole(index, 0) >= largest_count_)
                fail(index, in_quotes(index),
                     "an index below " + number(largest_count_) + ", the largest 'count' of an <accessor>");
        }
        for (const Tag& input : inputs_) {
            for (const char* name : {"semantic", "source"}) {
                if (!input.values.count(name)) fail(input.name, "<input> without " + in_quotes(name), "that attribute");
            }
        }
        if (scene_.data() && !has_scene_url_) fail(scene_, "<instance_visual_scene> without 'url'", "that attribute");
        if (!scene_.data()) reader_.fail("<instance_visual_scene> within <scene>");
    }

 private:
    struct Tag {
        std::string_view name;
        std::map<std::string_view, std::string_view> values;
        size_t parameters = 0;  // of an accessor
        std::string_view value(std::string_view key) const {
            const auto found = values.find(key);
            return found == values.end() ? std::string_view() : found->second;
        }
    };
    [[noreturn]] void fail(std::string_view at, const std::string& found, const std::string& expected) const {
        reader_.fail_at(reader_.position(at), found, expected);
    }
    static std::string number(double x) { return std::to_string(static_cast<long long>(x)); }

    void attribute(std::string_view element, std::string_view name, std::string_view value) {
        if (tag_.name.data() != element.data()) begin(element);
        tag_.values[name] = value;
        if (element == "polylist" && name == "count") polylist_count_ = value;
        if (element == "accessor") accessors_.back().values[name] = value;
        if (element == "input") inputs_.back().values[name] = value;
        if (is_array(element) && name == "id") arrays_[value] = 0;
        if (!refused_) return;
        if (name == "id") ids_.insert(value);
        const bool refers = name == "url" || name == "source" || name == "target";
        if (element == "instance_visual_scene" && name == "url") has_scene_url_ = true;
        if (element == "input" && name == "semantic" && !kSemantics.count(value))
            fail(value, in_quotes(value), "a semantic of COLLADA, such as 'VERTEX'");
        if (refers && value.substr(0, 1) == "#" && element.substr(0, 3) != "tec") references_.push_back(value);
        if ((name == "count" || name == "stride" || name == "offset") && !is_whole(value))
            fail(value, in_quotes(value), "a whole number as " + in_quotes(name) + " of <" + std::string(element) + ">");
        if (element == "accessor" && name == "count") largest_count_ = std::max(largest_count_, whole(value, 0));
    }
    void begin(std::string_view element) {
        tag_ = {element, {}, 0};
        if (element == "accessor") accessors_.push_back(tag_);
        if (element == "input") inputs_.push_back(tag_);
        if (element == "param" && parent_ == "accessor" && !accessors_.empty()) ++accessors_.back().parameters;
        if (element == "instance_visual_scene") scene_ = element;
    }

    static bool is_array(std::string_view element) {
        return element.size() > 6 && element.substr(element.size() - 6) == "_array";
    }
    void content(std::string_view element, std::string_view words) {
        parent_ = element;
        if (refused_ && kWithoutText.count(element)) {
            for_words(words, [&](std::string_view word) {
                fail(word, in_quotes(word), "only elements in <" + std::string(element) + ">");
            });
        }
        const bool is_floats = element == "float_array" || element == "translate" || element == "scale" ||
                               element == "rotate" || element == "matrix" || element == "color" || element == "float";
        const bool is_indices = element == "p" || element == "vcount" || element == "h";
        if (!is_array(element) && !(refused_ && (is_floats || is_indices))) return;
        size_t found = 0;
        std::string_view largest = "0";
        for_words(words, [&](std::string_view word) {
            ++found;
            if (!refused_ || !(is_floats || is_indices)) return;
            if (!(is_floats ? is_number(word) : is_whole(word)))
                fail(word, in_quotes(word), is_floats ? "a number" : "an index");
            if (element == "p" && whole(word, 0) > whole(largest, 0)) largest = word;
        });
        const std::string_view count = tag_.value("count");
        if (is_array(element)) {  // assimp reads as many as it declares
            if (count.empty()) fail(element, "<" + std::string(element) + "> without 'count'", "that attribute");
            arrays_[tag_.value("id")] = std::min(found, static_cast<size_t>(std::max(0.0, whole(count, 0))));
        }
        if (element == "p" && largest != "0") largest_indices_.push_back(largest);
        if (refused_ && element == "float_array" && !count.empty() && number(double(found)) != count)
            fail(words, std::to_string(found) + " numbers in <float_array>", std::string(count) + ", its 'count'");
        if (element == "vcount" && found > 0 && number(double(found)) != polylist_count_)
            fail(words, std::to_string(found) + " numbers in <vcount>", polylist_count_ + ", the 'count' of its <polylist>");
    }

    void check_accessor(const Tag& tag) const {
        const std::string_view source = tag.value("source");
        const auto array = arrays_.find(source.substr(std::min<size_t>(1, source.size())));
        const double count = whole(tag.value("count"), 0), stride = whole(tag.value("stride"), 1);
        const double offset = whole(tag.value("offset"), 0), room = array == arrays_.end() ? 0 : double(array->second);
        if (array == arrays_.end() || count <= 0) return;
        if (offset >= 0 && stride >= 0 && offset + stride * (count - 1) + double(tag.parameters) <= room) return;
        fail(tag.name,
             "an <accessor> to " + number(count) + " elements of " + number(stride) + " numbers from the number " +
                 number(offset) + " on",
             "elements within the " + number(room) + " numbers of " + in_quotes(source));
    }

    const bool refused_;  // assimp has refused the file, so that anything may be wrong
    Reader reader_;
    Tag tag_;                  // the last one that began
    std::string_view parent_;  // the element around the next tag
    std::string polylist_count_;
    std::vector<Tag> accessors_, inputs_;
    std::map<std::string_view, size_t> arrays_;  // numbers of each, by id
    std::set<std::string_view> ids_;
    std::vector<std::string_view> references_, largest_indices_;
    double largest_count_ = 0;
    std::string_view scene_;  // the name of its tag
    bool has_scene_url_ = false;
};

}  // namespace

std::string collada_accessor_damage(std::string_view text) {
    return damage_of(text, [&] { Collada(text, false).check(); });
}

std::string collada_damage(std::string_view text) {
    return damage_of(text, [&] { Collada(text, true).check(); });
}

}  // namespace assimp_import
