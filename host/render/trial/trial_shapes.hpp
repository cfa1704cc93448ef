// trial_shapes.hpp -- some shapes of a user's scene, which the scene of a trial gets too: kernels of shapes run on numbers that
// their own plugin has made.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity {

struct TrialShape {
    std::string id;  // of the plugin
    struct Part {
        ShapePart part;
        std::vector<float> more;  // its range of Scene::shape_numbers
    };
    std::vector<Part> parts;
};

// Up to three shapes of each kind, with up to four parts each; fewer if they have so many numbers that a command line does not
// hold them. A shape may lose parts.
std::vector<TrialShape> sample_shapes(const Scene& scene);
// Adds one of them to a scene, so that it fits into a ball of this centre and radius. kind: index in Scene::shape_kinds.
void add_shape(Scene& scene, const TrialShape& shape, rt_u32 kind, rt_u32 material, const std::array<float, 3>& center,
               float radius);

// A part as one word of a command line, and back. Numbers that are missing become 0.
std::string text_of(const TrialShape::Part& part);
TrialShape::Part read_part(const std::string& text);

}  // namespace clarity
