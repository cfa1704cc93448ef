#include "render/trial/trial_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace clarity {
namespace {

constexpr size_t kShapesOfKind = 3, kParts = 4;
// A word of a command line may have 128 KiB on Linux, all words of a program 2 MiB. A number takes 16 bytes at most.
constexpr size_t kNumbersOfPart = 7000, kNumbers = 60000;

}  // namespace

std::vector<TrialShape> sample_shapes(const Scene& scene) {
    std::vector<TrialShape> samples;
    std::vector<size_t> of_kind(scene.shape_kinds.size());
    size_t numbers = 0;
    for (const Shape& shape : scene.shapes) {
        if (of_kind[shape.kind] == kShapesOfKind) continue;
        TrialShape sample{scene.shape_kinds[shape.kind].id, {}};
        for (size_t i = 0; i < shape.part_count && sample.parts.size() < kParts; ++i) {
            const ShapePart& part = scene.shape_parts[shape.first_part + i];
            if (part.more_count > kNumbersOfPart || numbers + part.more_count > kNumbers) continue;
            numbers += part.more_count;
            const auto first = scene.shape_numbers.begin() + part.first_more;
            sample.parts.push_back({part, {first, first + part.more_count}});
        }
        if (sample.parts.empty()) continue;
        ++of_kind[shape.kind];
        samples.push_back(std::move(sample));
    }
    return samples;
}

void add_shape(Scene& scene, const TrialShape& shape, rt_u32 kind, rt_u32 material, const std::array<float, 3>& center,
               float radius) {
    Shape placed;
    placed.kind = kind;
    placed.material = material;
    placed.first_part = static_cast<rt_u32>(scene.shape_parts.size());
    placed.part_count = static_cast<rt_u32>(shape.parts.size());
    Bounds box;
    for (const TrialShape::Part& part : shape.parts) {
        box.add(part.part.min.data());
        box.add(part.part.max.data());
        scene.shape_parts.push_back(part.part);
        scene.shape_parts.back().first_more = static_cast<rt_u32>(scene.shape_numbers.size());
        scene.shape_parts.back().more_count = static_cast<rt_u32>(part.more.size());
        scene.shape_numbers.insert(scene.shape_numbers.end(), part.more.begin(), part.more.end());
    }
    float half = 0;
    for (size_t axis = 0; axis < 3; ++axis) half = std::max(half, 0.5f * (box.max[axis] - box.min[axis]));
    const float scale = half > 0 && std::isfinite(radius / half) ? radius / half : 1;
    for (size_t axis = 0; axis < 3; ++axis) {
        placed.world_from_object[5 * axis] = scale;
        placed.world_from_object[4 * axis + 3] = center[axis] - scale * 0.5f * (box.min[axis] + box.max[axis]);
    }
    scene.shapes.push_back(placed);
}

std::string text_of(const TrialShape::Part& part) {
    std::string text;
    const auto add = [&](const auto& numbers) {
        for (const float number : numbers) {
            char word[32];
            std::snprintf(word, sizeof word, "%.9g ", double(number));
            text += word;
        }
    };
    add(part.part.min);
    add(part.part.max);
    add(part.part.numbers);
    add(part.more);
    return text;
}

TrialShape::Part read_part(const std::string& text) {
    std::vector<float> numbers;
    const char* at = text.c_str();
    for (char* end = nullptr;; at = end) {
        const float number = std::strtof(at, &end);
        if (end == at) break;
        numbers.push_back(number);
    }
    constexpr size_t kFixed = 6 + RT_SHAPE_NUMBERS;
    TrialShape::Part part;
    if (numbers.size() < kFixed) numbers.resize(kFixed);
    std::copy_n(numbers.begin(), 3, part.part.min.begin());
    std::copy_n(numbers.begin() + 3, 3, part.part.max.begin());
    std::copy_n(numbers.begin() + 6, RT_SHAPE_NUMBERS, part.part.numbers.begin());
    part.more.assign(numbers.begin() + kFixed, numbers.end());
    return part;
}

}  // namespace clarity
