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
        template <class Parcel, class Self>
        static void visit(Parcel& parcel, Self& self) {
            parcel(self.part, self.more);
        }
    };
    std::vector<Part> parts;
    template <class Parcel, class Self>
    static void visit(Parcel& parcel, Self& self) {
        parcel(self.id, self.parts);
    }
};

// Up to three shapes of each kind, with up to four parts each; fewer if they have very many numbers. A shape may lose parts.
std::vector<TrialShape> sample_shapes(const Scene& scene);
// Adds one of them to a scene, so that it fits into a ball of this centre and radius. kind: index in Scene::shape_kinds.
void add_shape(Scene& scene, const TrialShape& shape, rt_u32 kind, rt_u32 material, const std::array<float, 3>& center,
               float radius);

}  // namespace clarity
