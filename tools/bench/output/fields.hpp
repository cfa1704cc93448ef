// fields.hpp -- a struct's members as a table of fields. From it JSON is written and read, and tables and charts are made.
#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

namespace clarity::bench {

using Json = nlohmann::ordered_json;

// How tables and the report show a statistic. Without `column` and `title` it is in JSON and CSV only.
struct Look {
    const char* column = nullptr;   // heading of its column in the terminal's tables, with its unit
    const char* title = nullptr;    // heading in the report
    const char* unit = nullptr;     // unit in the report
    const char* meaning = nullptr;  // explanation in the report, a paragraph; null: the report has no chart of it
    double scale = 1;               // factor from the stored to the shown value: 100 for percents
    int digits = -1;                // decimals; -1: three significant digits in all
    bool zero = false;              // true: 0 is a value; false: 0 means that there is none, and is not shown
};

template <class Owner>
struct Field {
    const char* key;                          // in JSON; CSV joins nested keys with dots
    std::function<Json(const Owner&)> write;  // returns null if there is nothing to write
    std::function<void(const Json&, Owner&)>
        read;  // reads a value which is not null; empty: the value follows from other fields
    Look look = {};
    std::function<double(const Owner&)> number = {};  // the stored value; empty: the field is not a number
    bool figure = false;                              // withheld unless the row is ok
};

template <class Owner>
using Fields = std::vector<Field<Owner>>;

// Six significant digits, which is more than any measurement has. Whole numbers stay whole. NaN and infinity become null.
Json number_json(double value);

template <class Value>
Json value_json(const Value& value) {
    if constexpr (std::is_floating_point_v<Value>)
        return number_json(value);
    else
        return value;
}

// A field which writes and reads the member as it is.
template <class Owner, class Value>
Field<Owner> plain(const char* key, Value Owner::* member, Look look = {}) {
    Field<Owner> field{key, [=](const Owner& o) { return value_json(o.*member); },
                       [=](const Json& json, Owner& o) { o.*member = json.get<Value>(); }, look};
    if constexpr (std::is_arithmetic_v<Value>) field.number = [=](const Owner& o) { return double(o.*member); };
    return field;
}

// A field that is written as null if the member is empty (0, "").
template <class Owner, class Value>
Field<Owner> unless_empty(const char* key, Value Owner::* member, Look look = {}) {
    Field<Owner> field = plain(key, member, look);
    field.write = [=](const Owner& o) { return o.*member > Value() ? value_json(o.*member) : Json(); };
    return field;
}

// The same field, but withheld unless the row is ok.
template <class Owner>
Field<Owner> figure_of(Field<Owner> field) {
    field.figure = true;
    return field;
}

template <class Owner>
Json write_fields(const Fields<Owner>& fields, const Owner& owner, bool with_figures = true) {
    Json json = Json::object();
    for (const Field<Owner>& field : fields) json[field.key] = with_figures || !field.figure ? field.write(owner) : Json();
    return json;
}

// Reads the fields which `json` has; fields which it lacks or which are null stay as they are. Throws Json::exception if a
// value has the wrong type.
template <class Owner>
void read_fields(const Json& json, const Fields<Owner>& fields, Owner& owner) {
    for (const Field<Owner>& field : fields)
        if (const auto at = json.find(field.key); field.read && at != json.end() && !at->is_null()) field.read(*at, owner);
}

// The field of that key; nullptr if there is none.
template <class Owner>
const Field<Owner>* find_field(const Fields<Owner>& fields, const std::string& key) {
    for (const Field<Owner>& field : fields)
        if (key == field.key) return &field;
    return nullptr;
}

}  // namespace clarity::bench
