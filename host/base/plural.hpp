// plural.hpp -- counts with their nouns, for people.
#pragma once
#include <cstdint>
#include <string>

namespace clarity {

// The noun for a count: "ray" for 1, else "rays", or `many` where that is not the noun with an s.
inline std::string noun(uint64_t count, const std::string& one, const std::string& many = {}) {
    return count == 1 ? one : many.empty() ? one + "s" : many;
}

// "1 light", "3 lights"; with `many`: "1 ray was", "3 rays were".
inline std::string plural(uint64_t count, const std::string& one, const std::string& many = {}) {
    return std::to_string(count) + " " + noun(count, one, many);
}

}  // namespace clarity
