// flip.hpp -- how much two pictures differ to a viewer that flips between them.
//
// P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. Fairchild, 2020, FLIP: A Difference Evaluator for
// Alternating Images. Pictures are filtered by the contrast sensitivity of the eye and compared as colours; edges and points
// that only one of them has count more.
#pragma once
#include <vector>

#include "base/pictures/image_io.hpp"

namespace clarity {

// A monitor of 0.7 m width and 3840 pixels, seen from 0.7 m.
inline constexpr double kFlipPixelsPerDegree = 67.0206;

// FLIP of each pixel, 0 (equal) to 1. The pictures have the same size and 3 channels of linear values, which are clamped to
// 0..1: so it is the FLIP of what a screen shows. Values that are not finite count as 0. Takes 27 floats a pixel while it
// works.
std::vector<float> flip(const FloatImage& test, const FloatImage& reference, double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace clarity
