// value.hpp -- a value of the file's JSON that knows its place, so that each error can name it.
#pragma once
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gltf_import {

// The file is wrong. The text says where and why, without the file's name.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Returns the text for a message: shortened, printable, in quotes.
std::string in_quotes(std::string_view text);

// Refers to the document; copies are cheap. All functions throw Error if the file has something else than they expect, for
// example "accessors[3].bufferView: found 17, expected the index of one of 4 bufferViews".
class Value {
 public:
    Value(const nlohmann::json& json, std::string path) : json_(&json), path_(std::move(path)) {}
    const nlohmann::json& json() const { return *json_; }
    const std::string& path() const { return path_; }
    [[noreturn]] void refuse(const std::string& expected) const;
    [[noreturn]] void refuse(const std::string& found, const std::string& expected) const;

    // Members of an object. Those with a second argument may be left out.
    bool has(const char* key) const;
    Value operator[](const char* key) const;
    Value object(const char* key) const;  // empty if it is left out
    Value list(const char* key) const;    // an array, empty if it is left out
    double number(const char* key, double otherwise) const;
    uint64_t count(const char* key, uint64_t otherwise) const;
    std::string text(const char* key, const std::string& otherwise) const;
    std::string name() const;  // its member 'name'; empty if that is left out, or no text
    template <size_t n>
    std::array<double, n> numbers(const char* key, std::array<double, n> otherwise) const {
        if (!has(key)) return otherwise;
        const Value array = (*this)[key];
        if (array.size() != n) array.refuse(std::to_string(n) + " numbers");
        for (size_t i = 0; i < n; ++i) otherwise[i] = array[i].number();
        return otherwise;
    }
    // The index of an element in `list`; nothing if it is left out.
    std::optional<size_t> index(const char* key, const Value& list) const;

    // Elements of an array.
    size_t size() const;
    Value operator[](size_t i) const;

    double number() const;
    uint64_t count() const;  // a whole number, 0 or more
    std::string text() const;
    size_t index(const Value& list) const;

 private:
    std::string found() const;
    const nlohmann::json* json_;
    std::string path_;
};

}  // namespace gltf_import
