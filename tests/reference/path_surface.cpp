#include "reference/path_surface.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "base/angle.hpp"
#include "reference/primitives.hpp"

namespace clarity::reference {
namespace {

// Trowbridge and Reitz 1975, called GGX by Walter et al. 2007: facets per solid angle of normals.
double facets(double cosine, double alpha) {
    const double c2 = cosine * cosine, t = c2 * (alpha * alpha - 1) + 1;
    return alpha * alpha / (kPi * t * t);
}
double lambda(double cosine, double alpha) {
    const double c2 = cosine * cosine;
    return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - c2) / c2) - 1);
}
double shown_and_lit(double mu_o, double mu_i, double alpha) {
    return 1 / (1 + lambda(mu_o, alpha) + lambda(mu_i, alpha));
}
double shown_and_passed(double mu_o, double mu_i, double alpha) {
    return 1 / ((1 + lambda(mu_o, alpha)) * (1 + lambda(mu_i, alpha)));
}
Vec mirrored(const Vec& wo, const Vec& h) {
    return 2 * dot(wo, h) * h - wo;
}
// The facet that sends wi to wo; its z is positive.
Vec facet_between(const Vec& wo, const Vec& wi, double eta) {
    const Vec h = normalized(wi[2] > 0 ? wo + wi : wo + eta * wi);
    return h[2] < 0 ? -1 * h : h;
}
Vec polar(double cosine, double phi) {
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}
// The cosine of a facet's normal whose density is D times that cosine (Walter et al. 2007, equation 35).
double facet_cosine(double u, double alpha) {
    return std::sqrt((1 - u) / (1 + (alpha * alpha - 1) * u));
}
double schlick(double color, double cosine) {
    return color + (1 - color) * std::pow(std::max(0.0, 1 - cosine), 5);
}
// Mean reflectance of a smooth dielectric from its thinner side, as Kulla and Conty 2017 fit it.
double mean_reflectance(double ior) {
    return (ior - 1) / (4.08567 + 1.00071 * ior);
}

}  // namespace

// 1 - E at cosines (k / kNodes)^2, and their mean.
struct PathSurface::Losses {
    static constexpr int kNodes = 48;
    double at[kNodes + 1], mean = 0;

    Losses(double alpha, double eta, bool metal) {
        for (int k = 0; k <= kNodes; ++k) at[k] = std::max(0.0, 1 - kept(std::max(1e-4, node(k)), alpha, eta, metal));
        const int steps = 4000;
        for (int i = 0; i < steps; ++i) {
            const double root = (i + 0.5) / steps, mu = root * root;
            mean += 2 * mu * of(mu) * 2 * root / steps;
        }
        mean = std::max(mean, 1e-12);
    }
    double of(double mu) const {
        const double place = std::sqrt(std::clamp(mu, 0.0, 1.0)) * kNodes;
        const int k = std::min(int(place), kNodes - 1);
        return at[k] + (at[k + 1] - at[k]) * (mu - node(k)) / (node(k + 1) - node(k));
    }
    static std::shared_ptr<const Losses> get(double alpha, double eta, bool metal) {
        static std::map<std::tuple<double, double, bool>, std::shared_ptr<const Losses>> known;
        auto& found = known[{alpha, eta, metal}];
        if (!found) found = std::make_shared<Losses>(alpha, eta, metal);
        return found;
    }

 private:
    static double node(int k) { return double(k) * k / (kNodes * kNodes); }
    static double kept(double mu, double alpha, double eta, bool metal) {
        const Vec wo = polar(mu, 0);
        const int along = 160, around = 96;
        double sum = 0;
        for (int i = 0; i < along; ++i) {
            const double z = (i + 0.5) / along, u = z * z * (3 - 2 * z), width = 6 * z * (1 - z) / along;  // dense at both ends
            for (int j = 0; j < around; ++j) {
                const Vec h = polar(facet_cosine(u, alpha), kPi * (j + 0.5) / around);
                const double to_facet = dot(wo, h);
                if (to_facet <= 0) continue;
                const double reflected = metal ? 1 : test::fresnel(to_facet, 1 / eta);
                const double up = mirrored(wo, h)[2];
                double share = up > 0 ? reflected * shown_and_lit(mu, up, alpha) : 0;
                if (reflected < 1) {
                    const double down = test::refracted(-1 * wo, h, 1 / eta)[2];
                    if (down < 0) share += (1 - reflected) * shown_and_passed(mu, -down, alpha);
                }
                sum += share * to_facet / (mu * h[2]) * width / around;
            }
        }
        return sum;
    }
};

PathSurface::PathSurface(const rt_material& m, const Vec& color, bool entering) : color_(color) {
    if (m.model == RT_MODEL_LAMBERT) diffuse_ = 1;
    if (m.model == RT_MODEL_CONDUCTOR) metal_ = 1;
    if (m.model == RT_MODEL_DIELECTRIC) glass_ = 1;
    if (m.model == RT_MODEL_WHITTED) {
        mirror_ = m.reflect;
        glass_ = m.refract;
        diffuse_ = std::max(0.0, 1 - mirror_ - glass_);
    } else if (m.model != RT_MODEL_LAMBERT) {
        alpha_ = double(m.roughness) * m.roughness;
    }
    eta_ = entering ? double(m.ior) : 1 / double(m.ior);
    if (rough() && !(m.flags & RT_MATERIAL_SINGLE_SCATTER)) {
        here_ = Losses::get(alpha_, metal_ > 0 ? 1 : eta_, metal_ > 0);
        if (glass_ > 0) beyond_ = Losses::get(alpha_, 1 / eta_, false);
    }
}

Vec PathSurface::value(const Vec& wo, const Vec& wi) const {
    Vec f{};
    if (wi[2] > 0) f = diffuse_ * wi[2] / kPi * color_;
    if (!rough() || wi[2] == 0) return f;
    const double mu_i = std::fabs(wi[2]);
    const Vec h = facet_between(wo, wi, eta_);
    const double to_facet = dot(wo, h), from_facet = dot(wi, h);
    if (metal_ > 0 && wi[2] > 0) {
        const double single = facets(h[2], alpha_) * shown_and_lit(wo[2], mu_i, alpha_) / (4 * wo[2]);
        for (int c = 0; c < 3; ++c) {
            f[c] += metal_ * schlick(color_[c], to_facet) * single;
            if (!here_) continue;
            const double mean = (20 * color_[c] + 1) / 21, kept = 1 - here_->mean;
            f[c] += metal_ * mean * mean * kept / (1 - mean * here_->mean) * here_->of(wo[2]) * here_->of(mu_i) / here_->mean *
                    mu_i / kPi;
        }
    }
    if (glass_ > 0) {
        double share = 0;
        if (wi[2] > 0) {
            share = test::fresnel(to_facet, 1 / eta_) * facets(h[2], alpha_) * shown_and_lit(wo[2], mu_i, alpha_) / (4 * wo[2]);
        } else if (to_facet > 0 && from_facet < 0) {
            const double bend = to_facet + eta_ * from_facet;
            share = (1 - test::fresnel(to_facet, 1 / eta_)) * facets(h[2], alpha_) * shown_and_passed(wo[2], mu_i, alpha_) *
                    to_facet * -from_facet / (bend * bend * wo[2]);
        }
        if (here_) {
            const double ior = std::max(eta_, 1 / eta_), let_in = 1 - mean_reflectance(ior);
            const double through = (eta_ > 1 ? let_in : let_in / (ior * ior)) * std::min(1.0, beyond_->mean / here_->mean);
            share += here_->of(wo[2]) * mu_i / kPi *
                     (wi[2] > 0 ? (1 - through) * here_->of(mu_i) / here_->mean
                                : through * beyond_->of(mu_i) / beyond_->mean / (eta_ * eta_));
        }
        for (int c = 0; c < 3; ++c) f[c] += glass_ * share * (wi[2] < 0 ? color_[c] : 1);
    }
    return f;
}

// Of draw() without deltas: half of the directions are cosine-distributed, on both sides for glass; the others come by facets.
double PathSurface::density(const Vec& wo, const Vec& wi) const {
    const bool both = glass_ > 0 && rough();
    const double cosine = both || wi[2] > 0 ? std::fabs(wi[2]) / kPi * (both ? 0.5 : 1) : 0;
    if (!rough()) return cosine;
    const Vec h = facet_between(wo, wi, eta_);
    const double to_facet = dot(wo, h), from_facet = dot(wi, h), normals = facets(h[2], alpha_) * h[2];
    const double reflected = metal_ > 0 ? 1 : test::fresnel(std::fabs(to_facet), 1 / eta_);
    double by_facets = 0;
    if (wi[2] > 0) {
        by_facets = reflected * normals / (4 * std::fabs(to_facet));
    } else if (both && to_facet > 0 && from_facet < 0) {
        const double bend = to_facet + eta_ * from_facet;
        by_facets = (1 - reflected) * normals * eta_ * eta_ * -from_facet / (bend * bend);
    }
    return 0.5 * cosine + 0.5 * by_facets;
}

Bounce PathSurface::draw(const Vec& wo, Dice& dice) const {
    Bounce b;
    const double spread = (diffuse_ > 0 ? diffuse_ : 0) + (rough() ? metal_ + glass_ : 0);
    const double smooth_glass = rough() ? 0 : glass_, smooth_metal = rough() ? 0 : metal_;
    const double sum = spread + mirror_ + smooth_glass + smooth_metal;
    if (sum <= 0) return b;
    double pick = dice() * sum;
    if ((pick -= mirror_ + smooth_metal) < 0) {
        b.delta = true;
        b.wi = {-wo[0], -wo[1], wo[2]};
        for (int c = 0; c < 3; ++c) b.weight[c] = sum * (mirror_ > 0 ? 1 : schlick(color_[c], wo[2]));
        return b;
    }
    if ((pick -= smooth_glass) < 0) {
        b.delta = true;
        if (dice() < test::fresnel(wo[2], 1 / eta_)) {
            b.wi = {-wo[0], -wo[1], wo[2]};
            b.weight = {sum, sum, sum};
        } else {
            b.wi = normalized(test::refracted(-1 * wo, {0, 0, 1}, 1 / eta_));
            b.weight = sum / (eta_ * eta_) * color_;
        }
        return b;
    }
    const bool glass = glass_ > 0 && rough();
    if (!rough() || dice() < 0.5) {
        b.wi = polar(std::sqrt(1 - dice()), 2 * kPi * dice());
        if (glass && dice() < 0.5) b.wi[2] = -b.wi[2];
    } else {
        Vec h = polar(facet_cosine(dice(), alpha_), 2 * kPi * dice());
        const double to_facet = dot(wo, h);
        if (glass && dice() >= test::fresnel(std::fabs(to_facet), 1 / eta_)) {
            if (to_facet <= 0) return b;
            b.wi = normalized(test::refracted(-1 * wo, h, 1 / eta_));
            if (b.wi[2] >= 0) return b;
        } else {
            b.wi = mirrored(wo, h);
            if (b.wi[2] <= 0) return b;
        }
    }
    const double p = density(wo, b.wi);
    if (p > 0) b.weight = sum / spread / p * value(wo, b.wi);
    return b;
}

}  // namespace clarity::reference
