#include "api/positions.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/numbers.hpp"
#include "import/sink/world_origin.hpp"
#include "scene/usable.hpp"

namespace clarity::api {

Problem problem_of_numbers(const float* numbers, size_t count, size_t of_each, const char* each) {
    if (are_usable(numbers, count)) return {};
    const float* const bad = std::find_if_not(numbers, numbers + count, is_usable<float>);
    const std::string where = std::string(each) + " " + std::to_string(size_t(bad - numbers) / of_each);
    if (!std::isfinite(*bad)) return "a number is not finite: of " + where;
    return "a number is beyond 1e15: " + exact_text(*bad) + " of " + where + "; give lengths in a larger unit";
}

Problem problem_of_positions(const float* numbers, size_t count) {
    if (Problem why = problem_of_numbers(numbers, count, 3, "vertex")) return why;
    import::WorldBox box;
    for (size_t i = 0; i + 2 < count; i += 3) box.add({numbers[i], numbers[i + 1], numbers[i + 2]});
    if (count == 0 || box.size() == 0 || box.size() >= import::kLeastSize) return {};
    return "all vertices lie within " + exact_text(float(box.size())) + ", less than " + exact_text(float(import::kLeastSize)) +
           ", where rays miss triangles; give lengths in a smaller unit";
}

}  // namespace clarity::api
