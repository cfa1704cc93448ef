#include "tools/compare/picture_errors.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/pictures/picture_read.hpp"
#include "tools/compare/flip.hpp"

namespace clarity {
namespace {

void check_sizes(const FloatImage& test, const FloatImage& reference) {
    const auto size = [](const FloatImage& image) { return std::to_string(image.width) + "x" + std::to_string(image.height); };
    if (test.width != reference.width || test.height != reference.height)
        throw Error(Exit::failed, "the pictures have " + size(test) + " and " + size(reference) +
                                      " pixels; only pictures of one size can be compared");
}

bool is_finite(const float* pixel) {
    return std::isfinite(pixel[0]) && std::isfinite(pixel[1]) && std::isfinite(pixel[2]);
}

// The mean over the channels.
double squared_error(const float* a, const float* b) {
    double square = 0;
    for (int c = 0; c < 3; ++c) square += (double(a[c]) - b[c]) * (double(a[c]) - b[c]) / 3;
    return square;
}

FloatImage part_of(const FloatImage& whole, int first_x, int first_y, int width, int height) {
    FloatImage part;
    part.width = unsigned(width);
    part.height = unsigned(height);
    part.channels = whole.channels;
    const auto at = [&](int row) {
        return whole.pixels.begin() + (ptrdiff_t(first_y + row) * whole.width + first_x) * ptrdiff_t(whole.channels);
    };
    for (int row = 0; row < height; ++row)
        part.pixels.insert(part.pixels.end(), at(row), at(row) + ptrdiff_t(width) * ptrdiff_t(whole.channels));
    return part;
}

}  // namespace

double rmse_of(const FloatImage& test, const FloatImage& reference) {
    check_sizes(test, reference);
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i + 3 <= test.pixels.size(); i += 3) {
        const float *a = &test.pixels[i], *b = &reference.pixels[i];
        if (is_finite(a) && is_finite(b)) sum += squared_error(a, b), ++count;
    }
    return std::sqrt(sum / double(std::max<size_t>(count, 1)));
}

PictureErrors picture_errors(const FloatImage& test, const FloatImage& reference) {
    check_sizes(test, reference);
    PictureErrors out;
    std::vector<double> squares;  // of each pixel, mean of its channels
    const std::vector<float> seen = flip(test, reference);
    for (size_t i = 0; i < seen.size(); ++i) {
        const float *a = &test.pixels[3 * i], *b = &reference.pixels[3 * i];
        if (!is_finite(a) || !is_finite(b)) {
            ++out.not_finite;
            continue;
        }
        const double square = squared_error(a, b);
        for (int c = 0; c < 3; ++c) {
            const double error = double(a[c]) - b[c];
            out.mean += a[c];
            out.reference_mean += b[c];
            if (std::abs(error) > out.largest) {
                out.largest = std::abs(error);
                out.largest_x = static_cast<unsigned>(i % test.width);
                out.largest_y = static_cast<unsigned>(i / test.width);
            }
        }
        const double luminance = .2126 * b[0] + .7152 * b[1] + .0722 * b[2];
        out.relmse += square / (luminance * luminance + .01);
        out.flip += seen[i];
        squares.push_back(square);
    }
    out.pixels = squares.size();
    if (squares.empty()) return out;
    const auto n = static_cast<double>(squares.size());
    const auto root_of_mean = [](const std::vector<double>& values, size_t count) {
        double sum = 0;
        for (size_t i = 0; i < count; ++i) sum += values[i];
        return std::sqrt(sum / static_cast<double>(std::max<size_t>(count, 1)));
    };
    out.mean /= 3 * n;
    out.reference_mean /= 3 * n;
    out.mean_ratio = out.reference_mean != 0 ? out.mean / out.reference_mean : std::nan("");
    out.relmse /= n;
    out.flip /= n;
    out.rmse = root_of_mean(squares, squares.size());
    std::sort(squares.begin(), squares.end());
    out.trimmed_rmse = root_of_mean(squares, squares.size() - squares.size() / 1000);
    return out;
}

double error_slope(const std::vector<std::pair<unsigned, double>>& points) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const auto& [samples, rmse] : points) {
        if (!(rmse > 0)) continue;
        const double of_samples = std::log(double(samples)), of_error = std::log(rmse);
        n += 1, x += of_samples, y += of_error, xx += of_samples * of_samples, xy += of_samples * of_error;
    }
    return n < 2 ? std::nan("") : (n * xy - x * y) / (n * xx - x * x);
}

ByteImage signed_error_picture(const FloatImage& test, const FloatImage& reference, double& full) {
    check_sizes(test, reference);
    const size_t pixels = size_t(test.width) * test.height;
    std::vector<double> errors(pixels), sizes;
    for (size_t i = 0; i < pixels; ++i) {
        const float *a = &test.pixels[3 * i], *b = &reference.pixels[3 * i];
        errors[i] = (double(a[0]) - b[0] + a[1] - b[1] + a[2] - b[2]) / 3;
        if (std::isfinite(errors[i])) sizes.push_back(std::abs(errors[i]));
    }
    full = 0;
    if (!sizes.empty()) {
        const auto at = sizes.begin() + static_cast<ptrdiff_t>((sizes.size() - 1) * 99 / 100);
        std::nth_element(sizes.begin(), at, sizes.end());
        full = *at > 0 ? *at : *std::max_element(sizes.begin(), sizes.end());
    }
    std::vector<uint8_t> rgba(4 * pixels);
    for (size_t i = 0; i < pixels; ++i) {
        const double share = full > 0 ? std::clamp(errors[i] / full, -1.0, 1.0) : 0;
        const auto rest = static_cast<uint8_t>(std::lround(255 * (1 - std::abs(share))));
        const bool finite = std::isfinite(errors[i]);
        rgba[4 * i] = !finite ? 0 : share >= 0 ? 255 : rest;
        rgba[4 * i + 1] = finite ? rest : 0;
        rgba[4 * i + 2] = !finite ? 0 : share <= 0 ? 255 : rest;
        rgba[4 * i + 3] = 255;
    }
    return {test.width, test.height, std::move(rgba)};
}

FloatImage read_reference(const std::string& file, const Settings& settings) {
    FloatImage picture = read_picture(file);
    const auto text = [](auto width, auto height) { return std::to_string(width) + "x" + std::to_string(height); };
    const Crop& crop = settings.crop;
    if (crop.whole_width > 0 && int(picture.width) == crop.whole_width && int(picture.height) == crop.whole_height)
        picture = part_of(picture, crop.x, crop.y, settings.width, settings.height);
    const std::string size = text(picture.width, picture.height), wanted = text(settings.width, settings.height);
    if (size != wanted)
        throw Error(Exit::usage,
                    "--reference " + file + ": has " + size + " pixels and the picture " + wanted + "; take --size " + size);
    return picture;
}

}  // namespace clarity
