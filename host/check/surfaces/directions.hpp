// directions.hpp -- how often a model of surfaces should draw directions of each cell of the hemisphere, and how often it does.
#pragma once
#include <random>
#include <string>
#include <vector>

#include "check/surfaces/hemisphere.hpp"

namespace clarity::check {

// Queries of random u for one wo. wi is the normal.
std::vector<SurfaceQuery> random_draws(const float* wo, size_t count, std::mt19937& random);

// How far the counts of drawn directions are from the shares: beyond 4, the reason is not chance.
struct Misfit {
    double sigmas = 0;
    std::string worst;  // "near the direction (0, 0, 1) 20 of 20000 draws, expected 312"
};

// Cells of about as many draws each, and their shares by the density. Draws of their own decide how small cells are: where many
// come, or should come, they are small.
class DrawCells {
 public:
    DrawCells(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo, std::mt19937& random);
    double total() const { return total_; }  // the density's integral
    Misfit misfit_of(const std::vector<SurfaceAnswer>& drawn) const;

 private:
    struct Node {
        SquareCell cell;
        int parts = -1;  // the first of four
        double share = 0;
    };
    size_t leaf_of(Place place) const;
    std::vector<Node> nodes_;
    double total_ = 0;
};

}  // namespace clarity::check
