// path_surface.hpp -- surfaces as the path tracer means them, in double precision. Nothing here is taken from cl/: facets are
// drawn by their distribution and not by what is seen of them, and what is lost between facets is integrated for each surface
// anew.
#pragma once
#include <functional>
#include <memory>
#include <random>

#include "scene/scene.hpp"
#include "scene/vec.hpp"

namespace clarity::reference {

class Dice {
 public:
    explicit Dice(uint64_t seed) : random_(seed) {}
    double operator()() { return double(random_() >> 11) * 0x1p-53; }  // [0, 1)

 private:
    std::mt19937_64 random_;
};

// A direction drawn from a surface, in its frame. weight: f |cos| / density; of an absorbed path it is 0.
struct Bounce {
    Vec wi{}, weight{};
    bool delta = false;
};

// One side of a surface. Directions point away from it; z is the normal on the side of wo, so wo[2] > 0.
class PathSurface {
 public:
    // entering: wo is on the side that the surface's own normal points to. color: what stands for the material's.
    PathSurface(const rt_material& material, const Vec& color, bool entering);
    // f(wo, wi) |cos wi| without deltas.
    Vec value(const Vec& wo, const Vec& wi) const;
    Bounce draw(const Vec& wo, Dice& dice) const;

 private:
    struct Losses;  // of light that may meet one facet only
    double density(const Vec& wo, const Vec& wi) const;
    bool rough() const { return alpha_ > 0; }

    Vec color_;
    double diffuse_ = 0, mirror_ = 0, metal_ = 0, glass_ = 0;
    double alpha_ = 0, eta_ = 1;  // eta: ior beyond / ior on this side
    std::shared_ptr<const Losses> here_, beyond_;
};

}  // namespace clarity::reference
