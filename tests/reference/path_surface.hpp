// path_surface.hpp -- surfaces as the path tracer means them, in double precision. Nothing here is taken from cl/: facets are
// drawn by their distribution and not by what is seen of them.
#pragma once
#include <memory>

#include "reference/path_layers.hpp"
#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace clarity::reference {

// One side of a surface. Directions point away from it; z is the normal on the side of wo, so wo[2] > 0.
class PathSurface {
 public:
    // entering: wo is on the side that the surface's own normal points to. color: what stands for the material's.
    PathSurface(const MaterialValues& material, const Vec& color, bool entering);
    // f(wo, wi) |cos wi| without deltas.
    Vec value(const Vec& wo, const Vec& wi) const;
    Bounce draw(const Vec& wo, Dice& dice) const;
    // The share of its emission that leaves to wo.
    double shows(const Vec& wo) const { return layers_ ? layers_->shows(wo) : 1; }

 private:
    double density(const Vec& wo, const Vec& wi) const;
    bool rough() const { return facets_.rough(); }

    std::shared_ptr<const PathLayers> layers_;  // RT_MODEL_GLTF has nothing else
    Vec color_;
    double diffuse_ = 0, mirror_ = 0, metal_ = 0, glass_ = 0;
    Facets facets_;
    double eta_ = 1;      // ior beyond / ior on this side
    Over here_, beyond_;  // of light that may meet one facet only
};

}  // namespace clarity::reference
