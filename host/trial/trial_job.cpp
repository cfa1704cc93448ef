#include "trial/trial_job.hpp"

#include <algorithm>
#include <cmath>

namespace clarity {
namespace {

constexpr size_t kShapesOfKind = 3, kParts = 4;
// The scene of a trial stays small.
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

}  // namespace clarity
