#include "value.hpp"

#include <cmath>

namespace gltf_import {
namespace {

const nlohmann::json kEmptyArray = nlohmann::json::array(), kEmptyObject = nlohmann::json::object();

}  // namespace

std::string in_quotes(std::string_view text) {
    std::string out = "'";
    for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (text.size() > 60 ? "...'" : "'");
}

std::string Value::found() const {
    if (json_->is_string()) return in_quotes(json_->get_ref<const std::string&>());
    if (json_->is_object()) return "an object";
    if (json_->is_array()) return "an array of " + std::to_string(json_->size());
    return json_->dump();
}

void Value::refuse(const std::string& expected) const {
    refuse(found(), expected);
}

void Value::refuse(const std::string& found, const std::string& expected) const {
    throw Error((path_.empty() ? "the top level" : path_) + ": found " + found + ", expected " + expected);
}

bool Value::has(const char* key) const {
    if (!json_->is_object()) refuse("an object");
    return json_->contains(key);
}

Value Value::operator[](const char* key) const {
    if (!has(key)) refuse("no member '" + std::string(key) + "'", "it there");
    return {json_->at(key), path_.empty() ? key : path_ + "." + key};
}

Value Value::object(const char* key) const {
    if (!has(key)) return {kEmptyObject, path_ + "." + key};
    const Value value = (*this)[key];
    if (!value.json_->is_object()) value.refuse("an object");
    return value;
}

Value Value::list(const char* key) const {
    if (!has(key)) return {kEmptyArray, path_.empty() ? key : path_ + "." + key};
    const Value value = (*this)[key];
    value.size();
    return value;
}

double Value::number(const char* key, double otherwise) const {
    return has(key) ? (*this)[key].number() : otherwise;
}

uint64_t Value::count(const char* key, uint64_t otherwise) const {
    return has(key) ? (*this)[key].count() : otherwise;
}

std::string Value::text(const char* key, const std::string& otherwise) const {
    return has(key) ? (*this)[key].text() : otherwise;
}

std::string Value::name() const {
    return has("name") && (*this)["name"].json().is_string() ? (*this)["name"].text() : "";
}

std::optional<size_t> Value::index(const char* key, const Value& list) const {
    if (!has(key)) return std::nullopt;
    return (*this)[key].index(list);
}

size_t Value::size() const {
    if (!json_->is_array()) refuse("an array");
    return json_->size();
}

Value Value::operator[](size_t i) const {
    return {json_->at(i), path_ + "[" + std::to_string(i) + "]"};
}

double Value::number() const {
    if (!json_->is_number()) refuse("a number");
    return json_->get<double>();
}

uint64_t Value::count() const {
    constexpr double kMost = 9007199254740992;  // 2^53: whole numbers up to here are exact in any program
    const double value = json_->is_number() ? json_->get<double>() : -1;
    if (!(value >= 0 && value <= kMost && value == std::floor(value))) refuse("a whole number, 0 or more");
    return static_cast<uint64_t>(value);
}

std::string Value::text() const {
    if (!json_->is_string()) refuse("a text");
    return json_->get<std::string>();
}

size_t Value::index(const Value& list) const {
    const uint64_t i = count();
    if (list.size() == 0) refuse("no index, because there are no " + list.path());
    if (i >= list.size()) refuse("the index of one of " + std::to_string(list.size()) + " " + list.path());
    return i;
}

}  // namespace gltf_import
