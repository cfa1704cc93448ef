// picture_errors.hpp -- figures of how much a picture differs from a reference.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/pictures/image_io.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

struct PictureErrors {
    uint64_t pixels = 0,
             not_finite = 0;  // pixels with a value that is not finite in either picture are left out of all figures
    double mean = 0, reference_mean = 0;  // over pixels and channels
    double mean_ratio = 0;                // mean / reference_mean; NaN where the reference is black
    double rmse = 0;                      // over pixels and channels
    // The squared error of a pixel, by its squared luminance in the reference (Rec. 709) + 0.01; the mean over pixels.
    double relmse = 0;
    double trimmed_rmse = 0;  // RMSE without the worst 0.1 % of pixels: what a dozen fireflies do not decide
    double flip = 0;          // mean of FLIP
    double largest = 0;       // greatest absolute error of a channel, and its pixel
    unsigned largest_x = 0, largest_y = 0;
};

// Both pictures have 3 channels. Throws Error(failed) if their sizes differ.
PictureErrors picture_errors(const FloatImage& test, const FloatImage& reference);

// PictureErrors::rmse alone, which takes less time.
double rmse_of(const FloatImage& test, const FloatImage& reference);

// The exponent of the samples by which RMSE falls, -0.5 of independent samples: a line through the logarithms of (samples,
// RMSE). NaN if there are fewer than two points.
double error_slope(const std::vector<std::pair<unsigned, double>>& points);

// The signed error (mean of the channels) as colours: red where the picture is brighter than the reference, blue where it is
// darker, white where they are equal, black where a value is not finite. `full`: the error of the full colour; 99 % of pixels
// have less.
ByteImage signed_error_picture(const FloatImage& test, const FloatImage& reference, double& full);

// The picture that another one should come near.

// Reads the file of --reference. Of a part of a picture it may show the whole one. Throws Error(failed) if it cannot be read;
// with a size that is not the picture's, Error(usage).
FloatImage read_reference(const std::string& file, const Settings& settings);

}  // namespace clarity
