// path_facets.hpp -- rough surfaces in double precision: GGX with an alpha along x and one along y, and what its facets lose
// and send back, integrated for each surface anew. Directions are in the frame of the surface, whose normal is z.
#pragma once
#include <functional>
#include <memory>
#include <random>
#include <vector>

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

Vec polar(double cosine, double phi);
inline Vec mirrored(const Vec& wo, const Vec& h) {
    return 2 * dot(wo, h) * h - wo;
}
// The facet that sends wi to wo; its z is positive. eta: ior beyond / ior on the side of wo.
Vec facet_between(const Vec& wo, const Vec& wi, double eta);
// Schlick 1994: from `straight` to `grazing`.
double schlick(double straight, double cosine, double grazing = 1);

struct Facets {
    double x = 0, y = 0;  // alphas; 0: smooth
    double turn = 0;      // by which x is turned from the surface's, in radians
    bool rough() const { return x > 0 && y > 0; }
    bool even() const { return x == y; }
    // Per solid angle of normals: Trowbridge and Reitz 1975, called GGX by Walter et al. 2007.
    double density(const Vec& h) const;
    // Smith's G2 (Heitz 2014): seen and lit on one side, their heights the same; and of light that passes.
    double lit(const Vec& wo, const Vec& wi) const;
    double passed(const Vec& wo, const Vec& wi) const;
    // A normal with the density D times its cosine.
    Vec normal(double u, double v) const;

 private:
    double lambda(const Vec& w) const;
    Vec along_grain(const Vec& w) const;
};

// A function of directions that depends on the cosine, and of facets with a grain on the angle from it, between nodes; with its
// mean and standard deviation over the hemisphere.
class OverHemisphere {
 public:
    OverHemisphere(const Facets& facets, const std::function<double(const Vec&)>& of);
    double operator()(const Vec& w) const;
    double mean = 0, deviation = 0;

 private:
    static constexpr int kCosines = 48, kAngles = 9;
    double at(size_t angle, double mu) const;
    double turn_;
    std::vector<std::vector<double>> values_;  // for each angle from the grain, at cosines (k / kCosines)^2
};
using Over = std::shared_ptr<const OverHemisphere>;

// The share of light that is lost when light meets one facet only: of a metal with F = 1, and of a dielectric, where light that
// goes through is not lost. What `facets` with F = (1 - cos)^5 send back.
Over lost_by_metal(const Facets& facets);
Over lost_by_glass(const Facets& facets, double eta);
// The same of glass that reflects `share` of the light that meets a facet with a cosine.
Over lost_by_glass(const Facets& facets, double eta, const std::function<double(double)>& share);
Over sent_at_grazing(const Facets& facets);
// Mean reflectance of a smooth dielectric from its thinner side, as Kulla and Conty 2017 fit it.
double mean_reflectance(double ior);

}  // namespace clarity::reference
