#include "reference/path_surface.hpp"

#include <algorithm>

#include "base/angle.hpp"
#include "reference/primitives.hpp"

namespace clarity::reference {
PathSurface::PathSurface(const MaterialValues& m, const Vec& color, bool entering) : color_(color) {
    if (m.model == RT_MODEL_GLTF) layers_ = PathLayers::of(m, color, entering);
    if (m.model == RT_MODEL_GLTF || m.model == RT_MODEL_UNLIT) return;
    if (m.model == RT_MODEL_LAMBERT) diffuse_ = 1;
    if (m.model == RT_MODEL_CONDUCTOR) metal_ = 1;
    if (m.model == RT_MODEL_DIELECTRIC) glass_ = 1;
    if (m.model == RT_MODEL_WHITTED) {
        mirror_ = m.reflect;
        glass_ = m.refract;
        diffuse_ = std::max(0.0, 1 - mirror_ - glass_);
    } else if (m.model != RT_MODEL_LAMBERT) {
        facets_.x = facets_.y = double(m.roughness) * m.roughness;
    }
    eta_ = entering ? double(m.ior) : 1 / double(m.ior);
    if (rough() && !(m.flags & RT_MATERIAL_SINGLE_SCATTER)) {
        here_ = metal_ > 0 ? lost_by_metal(facets_) : lost_by_glass(facets_, eta_);
        if (glass_ > 0) beyond_ = lost_by_glass(facets_, 1 / eta_);
    }
}

Vec PathSurface::value(const Vec& wo, const Vec& wi) const {
    if (layers_) return layers_->value(wo, wi);
    Vec f{};
    if (wi[2] > 0) f = diffuse_ * wi[2] / kPi * color_;
    if (!rough() || wi[2] == 0) return f;
    const double mu_i = std::fabs(wi[2]);
    const Vec h = facet_between(wo, wi, eta_);
    const double to_facet = dot(wo, h), from_facet = dot(wi, h);
    if (metal_ > 0 && wi[2] > 0) {
        const double single = facets_.density(h) * facets_.lit(wo, wi) / (4 * wo[2]);
        for (int c = 0; c < 3; ++c) {
            f[c] += metal_ * schlick(color_[c], to_facet) * single;
            if (!here_) continue;
            const double mean = (20 * color_[c] + 1) / 21, kept = 1 - here_->mean;
            f[c] +=
                metal_ * mean * mean * kept / (1 - mean * here_->mean) * (*here_)(wo) * (*here_)(wi) / here_->mean * mu_i / kPi;
        }
    }
    if (glass_ > 0) {
        double share = 0;
        if (wi[2] > 0) {
            share = test::fresnel(to_facet, 1 / eta_) * facets_.density(h) * facets_.lit(wo, wi) / (4 * wo[2]);
        } else if (to_facet > 0 && from_facet < 0) {
            const double bend = to_facet + eta_ * from_facet;
            share = (1 - test::fresnel(to_facet, 1 / eta_)) * facets_.density(h) * facets_.passed(wo, wi) * to_facet *
                    -from_facet / (bend * bend * wo[2]);
        }
        if (here_) {
            const double ior = std::max(eta_, 1 / eta_), let_in = 1 - mean_reflectance(ior);
            const double through = (eta_ > 1 ? let_in : let_in / (ior * ior)) * std::min(1.0, beyond_->mean / here_->mean);
            share += (*here_)(wo)*mu_i / kPi *
                     (wi[2] > 0 ? (1 - through) * (*here_)(wi) / here_->mean
                                : through * (*beyond_)(wi) / beyond_->mean / (eta_ * eta_));
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
    const double to_facet = dot(wo, h), from_facet = dot(wi, h), normals = facets_.density(h) * h[2];
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
    if (layers_) return layers_->draw(wo, dice);
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
        const double u = dice();
        const Vec h = facets_.normal(u, dice());
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
