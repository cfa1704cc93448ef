// compare.hpp -- two answers to the same rays, and how far they may differ.
#pragma once
#include <string>

#include "conformance/oracle.hpp"
#include "support/workbench.hpp"

namespace clarity::test {

// t within this of the oracle's, relative, or as near as the origin's own coordinates are known (for rays that start close to
// what they hit); anything else counts as a differing hit.
inline constexpr double kTolerance = 1e-5;

struct Comparison {
    size_t rays = 0, hits = 0;
    size_t missed = 0;      // the oracle hits and we do not
    size_t invented = 0;    // we hit and the oracle does not
    size_t elsewhere = 0;   // both hit, t differs by more than kTolerance
    size_t grazing = 0;     // those of `elsewhere` that the rounding of the ray's direction explains: Oracle::within_rounding
    size_t overruled = 0;   // differing, but all triangles in double precision say what we say
    size_t other_prim = 0;  // t agrees, another primitive is named that does not lie there
    size_t ties = 0;        // t agrees, another primitive is named that lies there too
    double worst_t = 0;     // relative difference, of those that agree
    std::string first;      // the first difference, in words

    size_t differing() const { return missed + invented + elsewhere; }
    // Those that nothing excuses.
    size_t wrong() const { return differing() - grazing - overruled; }
    void add(const Comparison& other);
    std::string text() const;
};

// Our t (infinite: missed), and where prims is not null the primitive numbers, against the truth of the rays.
Comparison compare(const Oracle& oracle, const std::vector<Truth>& truth, const std::vector<Ray>& rays,
                   const std::vector<float>& t, const std::vector<float>* prims);

}  // namespace clarity::test
