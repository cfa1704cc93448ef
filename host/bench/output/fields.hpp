// fields.hpp -- the members of a struct as rows of a table, from which JSON is written and read, and columns are drawn.
#pragma once
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

namespace clarity::bench {

using Json = nlohmann::ordered_json;

// How a statistic looks where a person reads it. Without `column` and `title` it is in JSON and CSV only.
struct Look {
    const char* column = nullptr;   // head of its column in the terminal's tables, with its unit
    const char* title = nullptr;    // in the report
    const char* unit = nullptr;     // in the report
    const char* meaning = nullptr;  // in the report, a paragraph; null: it has no chart of its own
    double scale = 1;               // what is shown by what is stored: 100 for percents
    int digits = -1;                // behind the decimal point; -1: three significant digits in all
    bool zero = false;              // 0 is a value; else it says that there is none
};

template <class Owner>
struct Field {
    const char* key;                                // in JSON; CSV joins nested keys by a dot
    std::function<Json(const Owner&)> write;        // null: there is nothing to say
    std::function<void(const Json&, Owner&)> read;  // of a value that is not null; empty: it follows from other fields
    Look look = {};
    std::function<double(const Owner&)> number = {};  // as stored; empty: it is none
    bool figure = false;                              // withheld unless the row is ok
};

template <class Owner>
using Fields = std::vector<Field<Owner>>;

// Six significant digits, more than any measurement has; whole numbers stay whole; null for what is no number.
Json number_json(double value);

template <class Value>
Json value_json(const Value& value) {
    if constexpr (std::is_floating_point_v<Value>)
        return number_json(value);
    else
        return value;
}

// A member as it is.
template <class Owner, class Value>
Field<Owner> plain(const char* key, Value Owner::*member, Look look = {}) {
    Field<Owner> field{key, [=](const Owner& o) { return value_json(o.*member); },
                       [=](const Json& json, Owner& o) { o.*member = json.get<Value>(); }, look};
    if constexpr (std::is_arithmetic_v<Value>) field.number = [=](const Owner& o) { return double(o.*member); };
    return field;
}

// A member whose empty value (0, "") says that there is nothing to say.
template <class Owner, class Value>
Field<Owner> unless_empty(const char* key, Value Owner::*member, Look look = {}) {
    Field<Owner> field = plain(key, member, look);
    field.write = [=](const Owner& o) { return o.*member > Value() ? value_json(o.*member) : Json(); };
    return field;
}

// The same, withheld unless the row is ok.
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

// Fields that `json` lacks, or that are null, stay as they are. Throws Json::exception for values of another kind.
template <class Owner>
void read_fields(const Json& json, const Fields<Owner>& fields, Owner& owner) {
    for (const Field<Owner>& field : fields)
        if (const auto at = json.find(field.key); field.read && at != json.end() && !at->is_null()) field.read(*at, owner);
}

// nullptr: there is none of that key.
template <class Owner>
const Field<Owner>* find_field(const Fields<Owner>& fields, const std::string& key) {
    for (const Field<Owner>& field : fields)
        if (key == field.key) return &field;
    return nullptr;
}

}  // namespace clarity::bench
