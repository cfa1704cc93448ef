// compare.hpp -- compares our answers to rays with the oracle's; says how far they may differ.
#pragma once
#include <string>

#include "base/pictures/image_io.hpp"
#include "conformance/oracle.hpp"
#include "support/workbench.hpp"

namespace clarity::test {

// Largest relative difference of t from the oracle's. A difference below the rounding error of the origin's coordinates is also
// allowed (for rays that start close to the surface they hit). Any other hit counts as differing.
inline constexpr double kTolerance = 1e-5;

struct Comparison {
    size_t rays = 0, hits = 0;
    size_t missed = 0;      // the oracle hits, we do not
    size_t invented = 0;    // we hit, the oracle does not
    size_t elsewhere = 0;   // both hit, but t differs by more than kTolerance
    size_t grazing = 0;     // of `elsewhere`: explained by the rounding of the ray's direction, see Oracle::within_rounding
    size_t overruled = 0;   // differing, but testing all triangles in double precision agrees with us
    size_t other_prim = 0;  // t agrees, but we name another primitive, which is not there
    size_t ties = 0;        // t agrees, and we name another primitive, which is there too
    double worst_t = 0;     // largest relative difference among the hits that agree
    std::string first;      // describes the first difference

    size_t differing() const { return missed + invented + elsewhere; }
    // Number of differences without an explanation.
    size_t wrong() const { return differing() - grazing - overruled; }
    void add(const Comparison& other);
    std::string text() const;
};

// Compares t (infinite: no hit) and, if prims is not null, the primitive numbers with the oracle's answers.
Comparison compare(const Oracle& oracle, const std::vector<Truth>& truth, const std::vector<Ray>& rays, const FloatPixels& t,
                   const FloatPixels* prims);

}  // namespace clarity::test
