// key.hpp -- a member of a material or a light as data. Statements of text scenes, edits, the panel, saved scenes, validation,
// poses and the reference are made from tables of keys: material_keys.hpp, light_kinds.hpp.
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "rt_plugin.h"

namespace clarity {

// How a transform changes the numbers of a key.
enum class Moves { never, point, direction, vector, length };

// A key. `offset` and `bit` place its value in the struct.
struct Key {
    const char* name = "";
    const char* label = "";              // in the panel
    const char* help = "";               // what the number is, in few words
    const char* more = "";               // further words of its tooltip and the reference
    rt_u32 kind = RT_KEY_NUMBER;         // RT_KEY_NUMBER, _POINT, _VECTOR, _COLOR, _WORD or _FLAG
    double min = 0, max = 0;             // of each number
    std::array<float, 3> def{};          // a word's number, a flag's 0 or 1
    const char* const* words = nullptr;  // of RT_KEY_WORD, NULL-terminated
    size_t offset = 0;                   // of the member, in bytes
    rt_u32 bit = 0;                      // words and flags: the bit that holds the value; 0: the whole member does
    bool inverted = false;               // the bit is set where the value is 0; the vector points the other way
    Moves moves = Moves::never;
    bool logarithmic = false;        // slider
    float step = 0;                  // of a field that is dragged; 0: a slider, or a step by the scene's size
    bool alias = false;              // another name for the member of the key before it
    bool follows_model = false;      // the model of a material changes it, too
    rt_u32 models = 0;               // 1 << RT_MODEL_* of the models that have it; 0: of all
    bool reversed_in_edits = false;  // edits have the opposite vector, as those of older versions do
};

// What is left of its range if the largest number has no meaning of its own: what text can hold.
inline constexpr double kMostNumber = 1e15;

// How many floats a key has: 1 or 3.
size_t count_of(const Key& key);
// Reads and writes the value in a struct.
std::array<float, 3> value_of(const Key& key, const void* values);
void set_value(const Key& key, void* values, const std::array<float, 3>& value);
// Why the value is not allowed: "from 0 to 1", or nothing.
Problem range_fault(const Key& key, const std::array<float, 3>& value);
// "`reflect` is 2, expected from 0 to 1" for a key that is not in its range, or nothing; of a table for the first one.
Problem fault_of(const Key& key, const void* values);
Problem fault_of(const std::vector<Key>& keys, const void* values);
// The nearest value that is allowed. The default in place of what is not finite, or below a range that begins above 0.
std::array<float, 3> nearest_value(const Key& key, const std::array<float, 3>& value);
// A value as a text that reads back to the same value. between: what stands between its numbers.
std::string value_text(const Key& key, const std::array<float, 3>& value, const char* between);
// Reads such a text, with commas. Returns false, and in `expected` what is allowed.
bool read_value(const Key& key, const std::string& text, std::array<float, 3>& value, std::string& expected);

const Key* find_key(const std::vector<Key>& keys, const std::string& name);
// A table as importers see it. id: the statement's word, or its kind.
struct PluginKeys {
    PluginKeys(const char* id, const std::vector<Key>& table);
    PluginKeys(PluginKeys&&) = default;  // which does not move the keys

    std::vector<rt_key> keys;
    rt_primitive_kind kind{};
};

// The rows of a table.
Key number_key(const char* name, size_t offset, double min, double max, float def);
Key color_key(const char* name, size_t offset, double max, float grey);
Key point_key(const char* name, size_t offset, const std::array<float, 3>& def);
Key vector_key(const char* name, size_t offset, const std::array<float, 3>& def);
Key word_key(const char* name, size_t offset, rt_u32 bit, const char* const* words);
Key flag_key(const char* name, size_t offset, rt_u32 bit, bool def = false);
// A key with its words for people.
Key shown(Key key, const char* label, const char* help, const char* more = "");

}  // namespace clarity
