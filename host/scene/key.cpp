#include "scene/key.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/numbers.hpp"

namespace clarity {
namespace {

bool is_choice(const Key& key) {
    return key.kind == RT_KEY_WORD || key.kind == RT_KEY_FLAG;
}

const char* const kFlagWords[] = {"false", "true", nullptr};
const char* const* words_of(const Key& key) {
    return key.kind == RT_KEY_FLAG ? kFlagWords : key.words;
}

template <class Member>
Member& member(void* values, size_t offset) {
    return *reinterpret_cast<Member*>(static_cast<char*>(values) + offset);
}
template <class Member>
const Member& member(const void* values, size_t offset) {
    return *reinterpret_cast<const Member*>(static_cast<const char*>(values) + offset);
}

bool are_finite(const std::array<float, 3>& value) {
    return std::all_of(value.begin(), value.end(), [](float x) { return std::isfinite(x); });
}

// The limits as the floats that values are. Text that names a limit is rounded to the same float, so it is in the range: the
// float that is nearest to 1e-12 is less than 1e-12.
struct Limits {
    explicit Limits(const Key& key) : least(static_cast<float>(key.min)), most(static_cast<float>(key.max)) {}
    bool hold(float x) const { return x >= least && x <= most; }  // no for NaN

    float least, most;
};

}  // namespace

size_t count_of(const Key& key) {
    return key.kind == RT_KEY_POINT || key.kind == RT_KEY_VECTOR || key.kind == RT_KEY_COLOR ? 3 : 1;
}

std::array<float, 3> value_of(const Key& key, const void* values) {
    std::array<float, 3> value{};
    if (is_choice(key)) {
        const rt_u32 word = member<rt_u32>(values, key.offset);
        value[0] = static_cast<float>(key.bit == 0 ? word : ((word & key.bit) != 0) != key.inverted);
        return value;
    }
    const float* numbers = &member<float>(values, key.offset);
    for (size_t k = 0; k < count_of(key); ++k) value[k] = key.inverted ? -numbers[k] : numbers[k];
    return value;
}

void set_value(const Key& key, void* values, const std::array<float, 3>& value) {
    if (is_choice(key)) {
        rt_u32& word = member<rt_u32>(values, key.offset);
        const bool set = (value[0] != 0) != key.inverted;
        word = key.bit == 0 ? static_cast<rt_u32>(value[0]) : set ? word | key.bit : word & ~key.bit;
        return;
    }
    float* numbers = &member<float>(values, key.offset);
    for (size_t k = 0; k < count_of(key); ++k) numbers[k] = key.inverted ? -value[k] : value[k];
}

Problem range_fault(const Key& key, const std::array<float, 3>& value) {
    const Limits limits(key);
    if (!std::all_of(value.begin(), value.begin() + count_of(key), [&](float x) { return limits.hold(x); }))
        return "from " + exact_text(key.min) + " to " + exact_text(key.max);
    if (key.kind == RT_KEY_VECTOR && value == std::array<float, 3>{}) return "a vector other than 0,0,0, which has no length";
    return {};
}

Problem fault_of(const Key& key, const void* values) {
    const std::array<float, 3> value = value_of(key, values);
    const std::string name = "`" + std::string(key.name) + "`";
    if (!are_finite(value)) return "not a finite number in " + name;
    if (const Problem fault = range_fault(key, value))
        return name + " is " + value_text(key, value, " ") + ", expected " + fault.text();
    return {};
}

Problem fault_of(const std::vector<Key>& keys, const void* values) {
    for (const Key& key : keys)
        if (Problem fault = fault_of(key, values)) return fault;
    return {};
}

std::array<float, 3> nearest_value(const Key& key, const std::array<float, 3>& value) {
    std::array<float, 3> nearest = value;
    const Limits limits(key);
    for (size_t k = 0; k < count_of(key); ++k) {
        // Files write 0 for what they do not say.
        const bool is_missing = !std::isfinite(value[k]) || (limits.least > 0 && value[k] < limits.least);
        nearest[k] = is_missing ? key.def[k] : std::clamp(value[k], limits.least, limits.most);
    }
    return range_fault(key, nearest) ? key.def : nearest;
}

std::string value_text(const Key& key, const std::array<float, 3>& value, const char* between) {
    if (is_choice(key) && value[0] >= 0 && value[0] <= static_cast<float>(key.max))
        return words_of(key)[static_cast<size_t>(value[0])];
    std::string text;
    for (size_t k = 0; k < count_of(key); ++k) text += (k ? between : "") + exact_text(value[k]);
    return text;
}

bool read_value(const Key& key, const std::string& text, std::array<float, 3>& value, std::string& expected) {
    value = {};
    if (is_choice(key)) {
        expected.clear();
        for (size_t i = 0; words_of(key)[i]; ++i) {
            value[0] = static_cast<float>(i);
            if (text == words_of(key)[i]) return true;
            expected += (i ? ", " : "one of ") + std::string(words_of(key)[i]);
        }
        return false;
    }
    const size_t count = count_of(key);
    expected = count == 1 ? "a number" : key.kind == RT_KEY_COLOR ? "r,g,b" : "x,y,z";
    const std::vector<float> numbers = read_numbers<float>(text);
    if (numbers.size() != count) return false;
    std::copy(numbers.begin(), numbers.end(), value.begin());
    expected = range_fault(key, value).text();
    return expected.empty();
}

const Key* find_key(const std::vector<Key>& keys, const std::string& name) {
    const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
    return found == keys.end() ? nullptr : &*found;
}

PluginKeys::PluginKeys(const char* id, const std::vector<Key>& table) {
    for (const Key& key : table) {
        rt_key row{};
        row.name = key.name, row.help = key.help, row.kind = key.kind;
        row.min = key.min, row.max = key.max, row.words = key.words;
        std::copy(key.def.begin(), key.def.end(), row.def);
        keys.push_back(row);
    }
    kind.struct_bytes = sizeof kind, kind.id = id;
    kind.keys = keys.data(), kind.key_count = static_cast<rt_u32>(keys.size()), kind.key_bytes = sizeof(rt_key);
}

Key number_key(const char* name, size_t offset, double min, double max, float def) {
    Key key;
    key.name = name, key.offset = offset, key.min = min, key.max = max, key.def[0] = def;
    return key;
}
Key color_key(const char* name, size_t offset, double max, float grey) {
    Key key = number_key(name, offset, 0, max, grey);
    key.kind = RT_KEY_COLOR, key.def = {grey, grey, grey}, key.help = "r g b";
    return key;
}
Key point_key(const char* name, size_t offset, const std::array<float, 3>& def) {
    Key key = number_key(name, offset, -kMostNumber, kMostNumber, 0);
    key.kind = RT_KEY_POINT, key.def = def, key.moves = Moves::point;
    return key;
}
Key vector_key(const char* name, size_t offset, const std::array<float, 3>& def) {
    Key key = point_key(name, offset, def);
    key.kind = RT_KEY_VECTOR, key.moves = Moves::vector;
    return key;
}
Key word_key(const char* name, size_t offset, rt_u32 bit, const char* const* words) {
    Key key = number_key(name, offset, 0, 0, 0);
    key.kind = RT_KEY_WORD, key.bit = bit, key.words = words;
    while (words[static_cast<size_t>(key.max) + 1]) ++key.max;
    return key;
}
Key flag_key(const char* name, size_t offset, rt_u32 bit, bool def) {
    Key key = number_key(name, offset, 0, 1, def ? 1.0f : 0.0f);
    key.kind = RT_KEY_FLAG, key.bit = bit, key.inverted = def;
    return key;
}
Key shown(Key key, const char* label, const char* help, const char* more) {
    key.label = label, key.help = help, key.more = more;
    return key;
}

}  // namespace clarity
