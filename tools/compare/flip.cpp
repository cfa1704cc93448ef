#include "tools/compare/flip.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/angle.hpp"
#include "base/parallel_for.hpp"

namespace clarity {
namespace {

using Plane = std::vector<float>;
using Planes = std::array<Plane, 3>;
using Color = std::array<double, 3>;

// From linear sRGB to XYZ (IEC 61966-2-1), and its white, D65.
constexpr double kXyzFromRgb[3][3] = {
    {.4124564, .3575761, .1804375}, {.2126729, .7151522, .0721750}, {.0193339, .1191920, .9503041}};
constexpr double kRgbFromXyz[3][3] = {
    {3.2404542, -1.5371385, -.4985314}, {-.9692660, 1.8760108, .0415560}, {.0556434, -.2040259, 1.0572252}};
constexpr Color kWhite = {.950428545, 1, 1.088900371};

Color times(const double (&m)[3][3], const Color& v) {
    Color out{};
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) out[i] += m[i][k] * v[k];
    return out;
}

Color relative_xyz(const Color& rgb) {
    Color xyz = times(kXyzFromRgb, rgb);
    for (int i = 0; i < 3; ++i) xyz[i] /= kWhite[i];
    return xyz;
}

// An opponent space that is linear in XYZ, so that it may be filtered.
Color ycxcz_of(const Color& rgb) {
    const Color v = relative_xyz(rgb);
    return {116 * v[1] - 16, 500 * (v[0] - v[1]), 200 * (v[1] - v[2])};
}

Color rgb_of_ycxcz(const Color& c) {
    const double y = (c[0] + 16) / 116;
    return times(kRgbFromXyz, {(c[1] / 500 + y) * kWhite[0], y * kWhite[1], (y - c[2] / 200) * kWhite[2]});
}

// CIELAB, with chroma scaled by lightness (the Hunt effect).
Color hunt_lab_of(const Color& rgb) {
    Color v = relative_xyz(rgb);
    constexpr double d = 6.0 / 29;
    for (double& x : v) x = x > d * d * d ? std::cbrt(x) : x / (3 * d * d) + 4.0 / 29;
    const double lightness = 116 * v[1] - 16;
    return {lightness, .01 * lightness * 500 * (v[0] - v[1]), .01 * lightness * 200 * (v[1] - v[2])};
}

double hyab(const Color& a, const Color& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

using Taps = std::vector<double>;  // at -radius .. radius

// A filter that is the product of one along x and one along y. Beyond the edge, pixels are as at the edge.
Plane filtered(const Plane& in, unsigned width, unsigned height, const Taps& along_x, const Taps& along_y) {
    const int radius = static_cast<int>(along_x.size() / 2), w = static_cast<int>(width), h = static_cast<int>(height);
    Plane between(in.size()), out(in.size());
    const auto pass = [&](const Plane& from, Plane& to, const Taps& taps, bool is_x) {
        parallel_for(height, [&](uint32_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < w; ++x) {
                double sum = 0;
                for (int k = -radius; k <= radius; ++k) {
                    const int at_x = is_x ? std::clamp(x + k, 0, w - 1) : x, at_y = is_x ? y : std::clamp(y + k, 0, h - 1);
                    sum += taps[static_cast<size_t>(k + radius)] * double(from[size_t(at_y) * width + size_t(at_x)]);
                }
                to[size_t(y) * width + size_t(x)] = static_cast<float>(sum);
            }
        });
    };
    pass(in, between, along_x, true);
    pass(between, out, along_y, false);
    return out;
}

Taps taps(int radius, double (*value)(double x, double width), double width) {
    Taps out;
    for (int k = -radius; k <= radius; ++k) out.push_back(value(k, width));
    return out;
}
double bell(double x, double sigma) {
    return std::exp(-x * x / (2 * sigma * sigma));
}

// ---- colours

// Contrast sensitivity of the eye as a sum of two Gaussians: amplitude and width of each, for luminance, red-green and
// blue-yellow.
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr Sensitivity kSensitivity[3] = {{1, .0047, 0, 1e-5}, {1, .0053, 0, 1e-5}, {34.1, .04, 13.5, .025}};

Plane seen(const Plane& in, unsigned width, unsigned height, const Sensitivity& s, double pixels_per_degree) {
    // exp(-pi^2 x^2 / b), x in degrees, is a Gaussian of standard deviation sqrt(b / 2) / pi degrees.
    const auto sigma = [&](double b) { return std::sqrt(b / 2) / kPi * pixels_per_degree; };
    const int radius = static_cast<int>(std::ceil(3 * sigma(.04)));  // of the widest
    Plane out(in.size(), 0);
    double whole = 0;
    const std::pair<double, double> bells[] = {{s.a1, s.b1}, {s.a2, s.b2}};
    for (const bool sums : {false, true})
        for (const auto& [a, b] : bells) {
            if (a == 0) continue;
            const Taps line = taps(radius, bell, sigma(b));
            double sum = 0;
            for (const double t : line) sum += t;
            const double weight = a * std::sqrt(kPi / b);
            if (!sums) {
                whole += weight * sum * sum;
                continue;
            }
            const Plane part = filtered(in, width, height, line, line);
            for (size_t i = 0; i < out.size(); ++i) out[i] += static_cast<float>(weight / whole * double(part[i]));
        }
    return out;
}

std::vector<Color> perceived(const Planes& ycxcz, unsigned width, unsigned height, double pixels_per_degree) {
    Planes filtered_planes;
    for (size_t c = 0; c < 3; ++c) filtered_planes[c] = seen(ycxcz[c], width, height, kSensitivity[c], pixels_per_degree);
    std::vector<Color> out(ycxcz[0].size());
    parallel_for(height, [&](uint32_t y) {
        for (size_t i = size_t(y) * width; i < size_t(y + 1) * width; ++i) {
            Color rgb = rgb_of_ycxcz({filtered_planes[0][i], filtered_planes[1][i], filtered_planes[2][i]});
            for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
            out[i] = hunt_lab_of(rgb);
        }
    });
    return out;
}

// 0..1: differences up to 0.4 of the greatest one take 0.95 of the range.
double color_difference(const Color& a, const Color& b) {
    constexpr double power = .7, knee = .4, at_knee = .95;
    static const double greatest = std::pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), power);
    const double d = std::pow(hyab(a, b), power), bend = knee * greatest;
    return d < bend ? at_knee / bend * d : at_knee + (d - bend) / (greatest - bend) * (1 - at_knee);
}

// ---- features

// Taps whose positive values sum to 1, and the negative ones to -1.
Taps balanced(Taps taps) {
    double up = 0, down = 0;
    for (const double t : taps) (t > 0 ? up : down) += t;
    for (double& t : taps) t /= t > 0 ? up : -down;
    return taps;
}

// Magnitudes of the gradient (edges) and of the second derivatives (points).
std::array<Plane, 2> features(const Plane& luminance, unsigned width, unsigned height, double pixels_per_degree) {
    constexpr double degrees = .082;  // width of what is found
    const double sigma = .5 * degrees * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * sigma));
    Taps smooth = taps(radius, bell, sigma);
    double sum = 0;
    for (const double t : smooth) sum += t;
    for (double& t : smooth) t /= sum;
    const Taps across[] = {
        balanced(taps(
            radius, [](double x, double s) { return -x * bell(x, s); }, sigma)),
        balanced(taps(radius, [](double x, double s) { return (x * x / (s * s) - 1) * bell(x, s); }, sigma))};
    std::array<Plane, 2> out;
    for (size_t k = 0; k < 2; ++k) {
        out[k] = filtered(luminance, width, height, across[k], smooth);
        const Plane down = filtered(luminance, width, height, smooth, across[k]);
        for (size_t i = 0; i < down.size(); ++i) out[k][i] = std::hypot(out[k][i], down[i]);
    }
    return out;
}

}  // namespace

std::vector<float> flip(const FloatImage& test, const FloatImage& reference, double pixels_per_degree) {
    const unsigned width = reference.width, height = reference.height;
    const size_t pixels = size_t(width) * height;
    std::vector<Color> colors[2];
    std::array<Plane, 2> found[2];
    for (size_t which = 0; which < 2; ++which) {
        const FloatImage& image = which == 0 ? test : reference;
        Planes planes;
        for (Plane& plane : planes) plane.resize(pixels);
        Plane luminance(pixels);
        for (size_t i = 0; i < pixels; ++i) {
            Color rgb;
            for (size_t c = 0; c < 3; ++c) {
                const double v = image.pixels[3 * i + c];
                rgb[c] = std::isfinite(v) ? std::clamp(v, 0.0, 1.0) : 0;
            }
            const Color c = ycxcz_of(rgb);
            for (size_t k = 0; k < 3; ++k) planes[k][i] = static_cast<float>(c[k]);
            luminance[i] = static_cast<float>((c[0] + 16) / 116);
        }
        colors[which] = perceived(planes, width, height, pixels_per_degree);
        found[which] = features(luminance, width, height, pixels_per_degree);
    }
    std::vector<float> out(pixels);
    for (size_t i = 0; i < pixels; ++i) {
        double feature = 0;
        for (size_t k = 0; k < 2; ++k) feature = std::max(feature, double(std::abs(found[0][k][i] - found[1][k][i])));
        feature = std::min(1.0, std::sqrt(feature / std::sqrt(2.0)));
        out[i] = static_cast<float>(std::pow(color_difference(colors[0][i], colors[1][i]), 1 - feature));
    }
    return out;
}

}  // namespace clarity
