// hemisphere.hpp -- integrals over the directions of a hemisphere, which is a square in cells of equal solid angle. Cells are
// split until the integral of each is known, so a lobe may be as narrow as 0.001 rad. And how often directions are drawn.
#pragma once
#include <array>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tools/check/surfaces/surface_probe.hpp"

namespace clarity::check {

// A unit vector with a cosine of z to the normal. turn: around it, in turns.
void set_direction(double z, double turn, float* w);
std::string direction_text(const float* w);

// A place of the unit square. The concentric map (Shirley, Chiu 1997, A Low Distortion Map Between Disk and Square) takes it
// onto a disk, where a direction lies at a distance of sqrt(1 - z) from the middle.
struct Place {
    double x = 0, y = 0;
};
void set_direction(Place place, float* w);
Place place_of(const float* w);

struct SquareCell {
    double x = 0, y = 0, side = 1;
    Place middle() const { return {x + side / 2, y + side / 2}; }
    // number: 0 to 3, as part_of() says.
    SquareCell part(int number) const;
    int part_of(Place place) const { return (place.x >= x + side / 2 ? 1 : 0) + (place.y >= y + side / 2 ? 2 : 0); }
};
inline constexpr double kLeastSide = 0x1p-20;  // of a cell: floats do not tell directions of smaller ones apart
std::vector<SquareCell> even_cells(int along_side);

// What is integrated, up to 6 numbers of one direction, 1/sr. The first one must not be far below what hints say of it.
using Integrals = std::array<double, 6>;
using Integrand = std::function<Integrals(const SurfaceQuery&, const SurfaceAnswer&)>;
// A direction that something is known of: how large the first number is there.
struct Hint {
    Place place;
    double value = 0;
};
// The integrals over each of these cells, for one wo. A cell in which a hint is much larger than all that was found is split,
// and cells near the mirror direction of wo are small: few places alone would miss a narrow lobe.
std::vector<Integrals> integrate(SurfaceProbe& probe, const SurfaceSubject& subject, const float* wo,
                                 const std::vector<SquareCell>& cells, const std::vector<Hint>& hints,
                                 const Integrand& integrand);

// How often a model of surfaces should draw directions of each cell of the hemisphere, and how often it does.

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
