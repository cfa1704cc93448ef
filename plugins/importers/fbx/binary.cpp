#include "binary.hpp"

namespace fbx_import {

// A record: its end, counted from the start of the file, the number of its values, the bytes of its values (32 bits each, 64
// from version 7500 on), the length of its name (8 bits), the name, the values, its child records. A record of zeros ends the
// list if there are child records. Source: Blender developer blog; the 64 bits: measured from maya_*_7500_binary.
size_t Document::read_records(size_t at, size_t end, uint32_t parent, int depth) {
    const auto refuse = [&](const std::string& what) { fail(bytes_.data() + at, what); };
    const bool wide = version_ >= 7500;
    const size_t word = wide ? 8 : 4, head = 3 * word + 1;
    const auto number = [&](size_t i) -> uint64_t {
        const char* from = bytes_.data() + at + i * word;
        return wide ? load<uint64_t>(from, big_endian_) : load<uint32_t>(from, big_endian_);
    };
    for (uint32_t last = 0; at < end;) {
        // Files that were cut right behind a record end the top level without the empty record.
        if (end - at < head) {
            refuse("the file or block ends within a record's head; expected " + std::to_string(head) + " bytes, found " +
                   std::to_string(end - at));
        }
        const uint64_t record_end = number(0), value_count = number(1), value_bytes = number(2);
        const size_t name_at = at + head, name_bytes = static_cast<unsigned char>(bytes_[name_at - 1]);
        const size_t values_at = name_at + name_bytes, values_end = values_at + value_bytes;
        if (record_end == 0) return name_at;
        if (record_end > end || record_end < values_at) {
            refuse("a record says that it ends at byte " + std::to_string(record_end) +
                   "; expected a place behind its head, and at most byte " + std::to_string(end));
        }
        const std::string_view name = bytes_.substr(name_at, name_bytes);
        if (value_bytes > record_end - values_at || value_count > value_bytes) {
            refuse("the record " + quoted(name) + " says that it has " + std::to_string(value_count) + " values in " +
                   std::to_string(value_bytes) + " bytes; " + std::to_string(record_end - values_at) + " bytes are there");
        }
        if (value_count > 0xFFFFFFFFu) refuse("there are more values than can be read");
        last = add_node(name, parent, last, depth);
        nodes_[last].values = bytes_.substr(values_at, value_bytes);
        nodes_[last].value_count = static_cast<uint32_t>(value_count);
        if (values_end < record_end) read_records(values_end, record_end, last, depth + 1);
        at = record_end;
    }
    return at;
}

// A value: the letter of its type, then its bytes. S and R have their length as 32 bits before them. Arrays have the count of
// their elements, the encoding (0 plain, 1 deflated) and their bytes in the file, 32 bits each. Source: Blender developer blog.
bool Values::next_binary(Value& value) {
    value = Value();
    if (taken_ == node_.value_count) return false;
    const auto need = [&](uint64_t bytes, const std::string& what) {
        if (rest_.size() >= bytes) return;
        document_.fail(rest_.data(), what + " of " + quoted(node_.name) + " needs " + std::to_string(bytes) +
                                         " bytes; its record has " + std::to_string(rest_.size()) + " more");
    };
    need(1, "a value");
    const char type = rest_[0];
    const char* begin = rest_.data();
    rest_.remove_prefix(1);
    const bool big = document_.big_endian_;
    uint64_t size = element_bytes(type);
    value.type = type;
    if (is_array(type)) {
        need(12, "an array's head");
        size = 12 + uint64_t(load<uint32_t>(rest_.data() + 8, big));
        value.kind = Value::array;
    } else if (type == 'S' || type == 'R') {
        need(4, "a text's length");
        size = load<uint32_t>(rest_.data(), big);
        rest_.remove_prefix(4);
        value.kind = Value::string;
    } else if (size == 0) {
        document_.fail(begin, "a value of " + quoted(node_.name) + " has the type " +
                                  std::to_string(static_cast<unsigned char>(type)) +
                                  "; expected one of the letters YCBIFDLSRfdilbc");
    }
    need(size, "a value");
    const char* at = rest_.data();
    value.text = rest_.substr(0, size);
    rest_.remove_prefix(size);
    ++taken_;
    if (value.kind != Value::none) return true;
    value.kind = type == 'F' || type == 'D' ? Value::real : Value::integer;
    value.number = type == 'D' ? load<double>(at, big) : type == 'F' ? load<float>(at, big) : 0;
    if (value.kind == Value::real) return true;
    value.whole = type == 'L'   ? load<int64_t>(at, big)
                  : type == 'I' ? load<int32_t>(at, big)
                  : type == 'Y' ? load<int16_t>(at, big)
                                : static_cast<unsigned char>(*at);
    value.number = static_cast<double>(value.whole);
    return true;
}

}  // namespace fbx_import
