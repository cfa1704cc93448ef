#include "reference/path_facets.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "base/angle.hpp"
#include "reference/primitives.hpp"

namespace clarity::reference {
namespace {

// The mean over what facets send back for light from wo. share: of the light that meets a facet with that cosine.
double sent(const Facets& facets, const Vec& wo, double eta, const std::function<double(double)>& share) {
    const int along = 160, around = facets.even() ? 96 : 128;
    double sum = 0;
    for (int i = 0; i < along; ++i) {
        const double z = (i + 0.5) / along, u = z * z * (3 - 2 * z), width = 6 * z * (1 - z) / along;  // dense at both ends
        for (int j = 0; j < around; ++j) {
            const Vec h = facets.normal(u, (j + 0.5) / around);
            const double to_facet = dot(wo, h);
            if (to_facet <= 0) continue;
            const double reflected = share(to_facet);
            const Vec up = mirrored(wo, h);
            double kept = up[2] > 0 ? reflected * facets.lit(wo, up) : 0;
            if (eta > 0 && reflected < 1) {
                const Vec down = test::refracted(-1 * wo, h, 1 / eta);
                if (down[2] < 0) kept += (1 - reflected) * facets.passed(wo, down);
            }
            sum += kept * to_facet / (wo[2] * h[2]) * width / around;
        }
    }
    return sum;
}

// kind: of what, apart from the facets. Known ones are not made again.
Over known(const Facets& f, double kind, const std::function<double(const Vec&)>& of) {
    static std::map<std::tuple<double, double, double, double>, Over> all;
    Over& found = all[{f.x, f.y, f.turn, kind}];
    if (!found) found = std::make_shared<const OverHemisphere>(f, of);
    return found;
}

}  // namespace

Vec polar(double cosine, double phi) {
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}
Vec facet_between(const Vec& wo, const Vec& wi, double eta) {
    const Vec h = normalized(wi[2] > 0 ? wo + wi : wo + eta * wi);
    return h[2] < 0 ? -1 * h : h;
}
double schlick(double straight, double cosine, double grazing) {
    return straight + (grazing - straight) * std::pow(std::max(0.0, 1 - cosine), 5);
}
double mean_reflectance(double ior) {
    return (ior - 1) / (4.08567 + 1.00071 * ior);
}

Vec Facets::along_grain(const Vec& w) const {
    const double c = std::cos(turn), s = std::sin(turn);
    return {c * w[0] + s * w[1], c * w[1] - s * w[0], w[2]};
}
double Facets::density(const Vec& h) const {
    const Vec g = along_grain(h);
    const double t = g[0] * g[0] / (x * x) + g[1] * g[1] / (y * y) + g[2] * g[2];
    return 1 / (kPi * x * y * t * t);
}
double Facets::lambda(const Vec& w) const {
    const Vec g = along_grain(w);
    return 0.5 * (std::sqrt(1 + (x * x * g[0] * g[0] + y * y * g[1] * g[1]) / (g[2] * g[2])) - 1);
}
double Facets::lit(const Vec& wo, const Vec& wi) const {
    return 1 / (1 + lambda(wo) + lambda(wi));
}
double Facets::passed(const Vec& wo, const Vec& wi) const {
    return 1 / ((1 + lambda(wo)) * (1 + lambda(wi)));
}
// Slopes of facets are those of alpha 1, stretched (Walter et al. 2007, equation 35).
Vec Facets::normal(double u, double v) const {
    const double slope = std::sqrt(u / (1 - u)), across = slope * x * std::cos(2 * kPi * v),
                 up = slope * y * std::sin(2 * kPi * v);
    const double c = std::cos(turn), s = std::sin(turn);
    return normalized({c * across - s * up, s * across + c * up, 1});
}

OverHemisphere::OverHemisphere(const Facets& facets, const std::function<double(const Vec&)>& of) : turn_(facets.turn) {
    const int angles = facets.even() ? 1 : kAngles;
    for (int a = 0; a < angles; ++a) {
        std::vector<double>& row = values_.emplace_back();
        const double phi = turn_ + (angles > 1 ? 0.5 * kPi * a / (angles - 1) : 0);
        for (int k = 0; k <= kCosines; ++k)
            row.push_back(of(polar(std::max(1e-4, double(k) * k / (kCosines * kCosines)), phi)));
    }
    double squares = 0;
    const int steps = 4000;
    for (int a = 0; a < angles; ++a) {
        const double share = (angles == 1 ? 1 : a == 0 || a == angles - 1 ? 0.5 / (angles - 1) : 1.0 / (angles - 1)) / steps;
        for (int i = 0; i < steps; ++i) {
            const double root = (i + 0.5) / steps, mu = root * root, value = at(size_t(a), mu);
            mean += share * 4 * mu * root * value;
            squares += share * 4 * mu * root * value * value;
        }
    }
    deviation = std::sqrt(std::max(0.0, squares - mean * mean));
}
double OverHemisphere::at(size_t angle, double mu) const {
    const double place = std::sqrt(std::clamp(mu, 0.0, 1.0)) * kCosines;
    const int k = std::min(int(place), kCosines - 1);
    const double low = double(k) * k, high = double(k + 1) * (k + 1), share = (mu * kCosines * kCosines - low) / (high - low);
    const std::vector<double>& row = values_[angle];
    return row[size_t(k)] + (row[size_t(k) + 1] - row[size_t(k)]) * share;
}
double OverHemisphere::operator()(const Vec& w) const {
    const double mu = std::fabs(w[2]);
    if (values_.size() == 1) return at(0, mu);
    const double angle = std::acos(std::min(1.0, std::fabs(std::cos(std::atan2(w[1], w[0]) - turn_))));
    const double place = angle / (0.5 * kPi) * (kAngles - 1);
    const int a = std::min(int(place), kAngles - 2);
    return at(size_t(a), mu) + (at(size_t(a) + 1, mu) - at(size_t(a), mu)) * (place - a);
}

Over lost_by_metal(const Facets& f) {
    return known(f, -1, [&](const Vec& w) { return std::max(0.0, 1 - sent(f, w, 0, [](double) { return 1.0; })); });
}
Over lost_by_glass(const Facets& f, double eta) {
    return known(f, eta, [&](const Vec& w) {
        return std::max(0.0, 1 - sent(f, w, eta, [&](double cosine) { return test::fresnel(cosine, 1 / eta); }));
    });
}
Over lost_by_glass(const Facets& f, double eta, const std::function<double(double)>& share) {
    return std::make_shared<const OverHemisphere>(f, [&](const Vec& w) { return std::max(0.0, 1 - sent(f, w, eta, share)); });
}
Over sent_at_grazing(const Facets& f) {
    const auto share = [](double cosine) { return std::pow(1 - cosine, 5); };
    return known(f, -2, [&](const Vec& w) { return f.rough() ? sent(f, w, 0, share) : share(w[2]); });
}

}  // namespace clarity::reference
