// directions.hpp -- how often a model of surfaces should draw directions of each cell of the hemisphere, and how often it does.
#pragma once
#include <random>
#include <string>
#include <vector>

#include "check/surfaces/surface_probe.hpp"

namespace clarity::check {

// A unit vector with a cosine of z to the normal. turn: around it, in turns.
void set_direction(double z, double turn, float* w);
std::string direction_text(const float* w);
// Queries of random u for one wo. wi is the normal.
std::vector<SurfaceQuery> random_draws(const float* wo, size_t count, std::mt19937& random);

// The share of draws that each cell gets by the density. Cells have equal solid angles.
struct CellShares {
    std::vector<double> shares;
    double total = 0;
};
// A lobe that is narrower than a part of a cell is integrated once more, with smaller parts; it may be as narrow as 0.002 rad.
CellShares shares_of(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo);

// How far the counts of drawn directions are from the shares: beyond 4, the reason is not chance.
struct Misfit {
    double sigmas = 0;
    std::string worst;  // "near the direction (0, 0, 1) 20 of 20000 draws, expected 312"
};
Misfit misfit_of(const std::vector<SurfaceAnswer>& drawn, const CellShares& expected);

}  // namespace clarity::check
