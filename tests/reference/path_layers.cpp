#include "reference/path_layers.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <string>

#include "base/angle.hpp"
#include "reference/primitives.hpp"

namespace clarity::reference {
namespace {

constexpr double kCoat = 0.04;         // reflectance of varnish straight on
constexpr double kLikeness = 0.95;     // how much alike two layers' albedos grow towards grazing angles
constexpr double kMeanCosine = 0.667;  // at which a film counts for the whole hemisphere

double largest(const Vec& v) {
    return std::max({v[0], v[1], v[2]});
}
// What facets lose comes back from further ones (Kulla and Conty 2017), each of which reflects once more.
double again(double mean, double lost) {
    return mean * mean * (1 - lost) / std::max(1e-9, 1 - mean * lost);
}
double schlick_mean(double straight, double grazing) {
    return (20 * straight + grazing) / 21;
}

// ---- fibres: KHR_materials_sheen

double sheen_shadow(double mu, double alpha) {
    const double t = (1 - alpha) * (1 - alpha);
    const auto mix = [&](double one, double zero) { return one + (zero - one) * t; };
    const double a = mix(21.5473, 25.3245), b = mix(3.82987, 3.32435), c = mix(0.19823, 0.16801), d = mix(-1.97760, -1.27393),
                 e = mix(-4.32054, -4.85967);
    const auto power = [&](double x) { return a / (1 + b * std::pow(x, c)) + d * x + e; };
    return std::exp(mu < 0.5 ? power(mu) : 2 * power(0.5) - power(1 - mu));
}
double sheen_value(const Vec& wo, const Vec& wi, double alpha) {
    const Vec h = normalized(wo + wi);
    const double facing = (2 + 1 / alpha) * std::pow(std::max(0.0, 1 - h[2] * h[2]), 0.5 / alpha) / (2 * kPi);
    return facing / ((1 + sheen_shadow(wo[2], alpha) + sheen_shadow(wi[2], alpha)) * 4 * wo[2]);
}
Over sheen_albedos(double alpha) {
    static std::map<double, Over> known;
    Over& found = known[alpha];
    if (found) return found;
    const auto albedo = [&](const Vec& wo) {
        const int up = 160, around = 96;
        double sum = 0;
        for (int i = 0; i < up; ++i)
            for (int j = 0; j < around; ++j) {
                const double root = (i + 0.5) / up;  // dense at grazing angles
                sum += sheen_value(wo, polar(root * root, kPi * (j + 0.5) / around), alpha) * 2 * root * 2 * kPi / up / around;
            }
        return sum;
    };
    return found = std::make_shared<const OverHemisphere>(Facets{}, albedo);
}

// ---- a film: KHR_materials_iridescence

// The eye's answer to a wave whose path is longer by `path` (m) and shifted by `shift`, for one channel of linear Rec. 709.
double seen_wave(double path, double shift, int channel) {
    const double phase = 2 * kPi * path;
    const double heights[] = {5.4856e-13, 4.4201e-13, 5.2481e-13, 9.7470e-14},
                 middles[] = {1.6810e6, 1.7953e6, 2.2084e6, 2.2399e6}, widths[] = {4.3278e9, 9.3046e9, 6.6121e9, 4.5282e9};
    double wave[4];
    for (int k = 0; k < 4; ++k)
        wave[k] = heights[k] * std::sqrt(2 * kPi * widths[k]) * std::cos(middles[k] * phase + shift) *
                  std::exp(-phase * phase * widths[k]) / 1.0685e-7;
    const double x = wave[0] + wave[3], y = wave[1], z = wave[2];
    if (channel == 0) return 3.2404542 * x - 1.5371385 * y - 0.4985314 * z;
    if (channel == 1) return -0.9692660 * x + 1.8760108 * y + 0.0415560 * z;
    return 0.0556434 * x - 0.2040259 * y + 1.0572252 * z;
}
double squared(double x) {
    return x * x;
}

}  // namespace

std::shared_ptr<const PathLayers> PathLayers::of(const MaterialValues& material, const Vec& color, bool entering) {
    static std::map<std::string, std::shared_ptr<const PathLayers>> known;
    std::string key(sizeof material + sizeof color, entering ? '1' : '0');
    std::memcpy(key.data(), &material, sizeof material);
    std::memcpy(key.data() + sizeof material, &color, sizeof color);
    auto& found = known[key + (entering ? "e" : "l")];
    if (!found) found = std::make_shared<const PathLayers>(material, color, entering);
    return found;
}

PathLayers::PathLayers(const MaterialValues& m, const Vec& color, bool entering) : color_(color) {
    const rt_layers& l = m.layers;
    const double other = 1 - double(l.metallic), clear = other * l.transmission;
    const bool solid = (l.flags & RT_LAYERS_SOLID) != 0;
    metal_ = l.metallic;
    gloss_ = solid ? other - clear : other;
    diffuse_ = other - clear;
    thin_ = solid ? 0 : clear;
    glass_ = solid ? clear : 0;
    ior_ = m.ior;
    eta_ = entering ? ior_ : 1 / ior_;
    grazing_ = l.specular_weight;
    for (size_t c = 0; c < 3; ++c)
        straight_[c] = std::min(grazing_ * squared((ior_ - 1) / (ior_ + 1)) * l.specular_color[c], grazing_);
    most_ = largest(straight_);
    film_ = l.iridescence;
    film_ior_ = l.iridescence_ior;
    film_nm_ = l.iridescence_thickness;

    const double alpha = double(m.roughness) * m.roughness;
    facets_ = {alpha, alpha};
    if (l.anisotropy > 0) {
        facets_.y = std::max(alpha, 1e-3);
        facets_.x = facets_.y + (1 - facets_.y) * squared(l.anisotropy);
        facets_.turn = l.anisotropy_rotation * kPi / 180;
    }
    spread_ = std::sqrt(0.5 * (squared(facets_.x) + squared(facets_.y)));
    bent_ = sent_at_grazing(facets_);
    if (facets_.rough()) lost_ = lost_by_metal(facets_);
    const double lost_mean = lost_ ? lost_->mean : 0;
    for (size_t c = 0; c < 3; ++c) {
        metal_again_[c] = again(schlick_mean(color_[c], 1), lost_mean);
        gloss_again_[c] = again(schlick_mean(straight_[c], grazing_), lost_mean);
    }
    if (glass_ > 0 && facets_.rough()) {
        const auto mean = [](const Vec& f) { return (f[0] + f[1] + f[2]) / 3; };
        glass_here_ = lost_by_glass(facets_, eta_, [&](double cosine) { return mean(glass(cosine, eta_)); });
        glass_beyond_ = lost_by_glass(facets_, 1 / eta_, [&](double cosine) { return mean(glass(cosine, 1 / eta_)); });
        const double straight = squared((ior_ - 1) / (ior_ + 1)), n = std::max(ior_, 1 / ior_);
        const double rise = std::max(0.0, mean_reflectance(n) - straight) / (1 - straight);
        glass_mean_ = mean(straight_) + (grazing_ - mean(straight_)) * rise;
    }
    coat_ = l.clearcoat;
    coat_facets_.x = coat_facets_.y = squared(l.clearcoat_roughness);
    coat_bent_ = sent_at_grazing(coat_facets_);
    if (coat_facets_.rough()) coat_lost_ = lost_by_metal(coat_facets_);
    const double coat_lost = coat_lost_ ? coat_lost_->mean : 0;
    coat_mean_ = coat_ * (kCoat * (1 - coat_lost - coat_bent_->mean) + coat_bent_->mean);
    sheen_ = to_vec(l.sheen_color);
    sheen_alpha_ = squared(std::max(0.1, double(l.sheen_roughness)));
    fibres_ = sheen_albedos(sheen_alpha_);
    for (double mu = 0.0004; mu < 1; mu += 0.001) sheen_kept_ = std::min(sheen_kept_, 1 / (*fibres_)({0, 0, mu}));
    sheen_mean_ = largest(sheen_) * sheen_kept_ * fibres_->mean;

    const double bare = most_ * (1 - lost_mean - bent_->mean) + grazing_ * bent_->mean;
    const double gloss_mean =
        lost_mean * largest(gloss_again_) + (film_ > 0 ? largest(gloss(kMeanCosine)) * (1 - lost_mean) : bare);
    // The mean of a product is more than that of the means, as all layers reflect most at grazing angles.
    const double parts[] = {(grazing_ - most_) * bent_->deviation / (1 - gloss_mean),
                            coat_ * coat_bent_->deviation / (1 - coat_mean_),
                            largest(sheen_) * sheen_kept_ * fibres_->deviation / (1 - sheen_mean_)};
    const double pairs = parts[0] * parts[1] + parts[0] * parts[2] + parts[1] * parts[2];
    inside_ = 1 / ((1 - gloss_mean) * (1 + kLikeness * pairs));
}

double PathLayers::coat_albedo(const Vec& w) const {
    const double lost = coat_lost_ ? (*coat_lost_)(w) : 0, bent = (*coat_bent_)(w);
    return coat_ * (kCoat * std::max(0.0, 1 - lost - bent) + bent);
}
double PathLayers::sheen_albedo(const Vec& w) const {
    return largest(sheen_) * sheen_kept_ * (*fibres_)(w);
}
double PathLayers::gloss_albedo(const Vec& w) const {
    const double lost = lost_ ? (*lost_)(w) : 0, bent = (*bent_)(w);
    const double once =
        film_ > 0 ? largest(gloss(std::fabs(w[2]))) * (1 - lost) : most_ * std::max(0.0, 1 - lost - bent) + grazing_ * bent;
    return once + lost * largest(gloss_again_);
}

double PathLayers::dim(const Vec& wo, const Vec& wi, double spread, Layers by) const {
    const auto below = [&](double o, double i, double mean) {
        const double both = std::max(0.0, (1 - o) * (1 - i));
        return (1 - spread) * std::sqrt(both) + spread * both / (1 - mean);
    };
    const double coat = below(coat_albedo(wo), coat_albedo(wi), coat_mean_);
    return by == Layers::varnish ? coat : coat * below(sheen_albedo(wo), sheen_albedo(wi), sheen_mean_);
}

// No more light may come out of a solid than goes in, and as much in either way.
double PathLayers::dim_through(const Vec& wo, const Vec& wi) const {
    return (1 - std::max(coat_albedo(wo), coat_albedo(wi))) * (1 - std::max(sheen_albedo(wo), sheen_albedo(wi)));
}

Vec PathLayers::film(double cosine, const Vec& straight) const {
    const double ramp = std::min(1.0, film_nm_ / 0.03), ior = 1 + (film_ior_ - 1) * ramp * ramp * (3 - 2 * ramp);
    const double inside2 = 1 - (1 - cosine * cosine) / (ior * ior);
    if (inside2 <= 0) return {1, 1, 1};
    const double inside = std::sqrt(inside2), above = schlick(squared((ior - 1) / (ior + 1)), cosine),
                 path = 2 * ior * film_nm_ * 1e-9 * inside;
    Vec found;
    for (int c = 0; c < 3; ++c) {
        const double root = std::sqrt(std::clamp(straight[size_t(c)], 0.0, 0.9999)), base = (1 + root) / (1 - root);
        const double below = schlick(squared((base - ior) / (base + ior)), inside);
        const double shift = (ior < 1 ? 0 : kPi) + (base < ior ? kPi : 0);
        const double both = std::clamp(above * below, 1e-5, 0.9999), once = squared(1 - above) * below / (1 - both);
        double sum = above + once, order = once - (1 - above);
        for (int m = 1; m <= 2; ++m) {
            order *= std::sqrt(both);
            sum += order * 2 * seen_wave(m * path, m * shift, c);
        }
        found[size_t(c)] = std::clamp(sum, 0.0, 1.0);
    }
    return found;
}
Vec PathLayers::metal(double cosine) const {
    const Vec filmed = film_ > 0 ? film(cosine, color_) : Vec{};
    Vec f;
    for (size_t c = 0; c < 3; ++c) f[c] = (1 - film_) * schlick(color_[c], cosine) + film_ * filmed[c];
    return f;
}
Vec PathLayers::gloss(double cosine) const {
    const Vec filmed = film_ > 0 ? film(cosine, 1 / std::max(1e-6, grazing_) * straight_) : Vec{};
    Vec f;
    for (size_t c = 0; c < 3; ++c) f[c] = (1 - film_) * schlick(straight_[c], cosine, grazing_) + film_ * grazing_ * filmed[c];
    return f;
}
Vec PathLayers::glass(double cosine, double eta) const {
    // By Fresnel's equations the reflectance rises from `straight` to 1. KHR_materials_specular has other ends, _iridescence a
    // film outside; total reflection stays.
    const double exact = test::fresnel(cosine, 1 / eta), straight = squared((ior_ - 1) / (ior_ + 1));
    if (exact >= 1) return {1, 1, 1};
    const double rise = std::max(0.0, exact - straight) / (1 - straight);
    const double thinner = eta > 1 ? cosine : std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
    const Vec filmed = film_ > 0 ? film(thinner, 1 / std::max(1e-6, grazing_) * straight_) : Vec{};
    Vec f;
    for (size_t c = 0; c < 3; ++c)
        f[c] = (1 - film_) * (straight_[c] + (grazing_ - straight_[c]) * rise) + film_ * grazing_ * filmed[c];
    return f;
}

Vec PathLayers::value(const Vec& wo, const Vec& wi) const {
    Vec f{};
    if (wi[2] == 0) return f;
    const bool above = wi[2] > 0;
    const double cosine = std::fabs(wi[2]), spread = cosine / kPi * dim(wo, wi, 1);
    const double many = lost_ ? (*lost_)(wo) * (*lost_)(wi) / lost_->mean : 0;
    const double under = diffuse_ * inside_ * (1 - gloss_albedo(wo)) * (1 - gloss_albedo(wi));
    for (size_t c = 0; c < 3; ++c)
        f[c] = spread * (above ? under * color_[c] + many * (metal_ * metal_again_[c] + gloss_ * gloss_again_[c])
                               : many * thin_ * color_[c] * (1 - gloss_again_[c]));
    if (facets_.rough()) {
        // Light through a sheet is mirrored to the other side.
        const Vec up{wi[0], wi[1], cosine}, h = facet_between(wo, up, 1);
        const double seen = facets_.density(h) * facets_.lit(wo, up) / (4 * wo[2]) * dim(wo, wi, spread_);
        const Vec bare = gloss(dot(wo, h)), shiny = metal(dot(wo, h));
        for (size_t c = 0; c < 3; ++c)
            f[c] += seen * (above ? gloss_ * bare[c] + metal_ * shiny[c] : thin_ * color_[c] * (1 - bare[c]));
    }
    if (glass_ > 0 && facets_.rough()) {
        const Vec h = facet_between(wo, wi, eta_);
        const double to_facet = dot(wo, h), from_facet = dot(wi, h), bend = to_facet + eta_ * from_facet;
        Vec lobe{};
        if (above || (to_facet > 0 && from_facet < 0)) {
            const Vec mirror = glass(to_facet, eta_);
            const double passes = facets_.passed(wo, wi) * to_facet * -from_facet / (bend * bend * wo[2]);
            for (size_t c = 0; c < 3; ++c)
                lobe[c] = facets_.density(h) *
                          (above ? mirror[c] * facets_.lit(wo, wi) / (4 * wo[2]) : color_[c] * (1 - mirror[c]) * passes);
        }
        const double n = std::max(eta_, 1 / eta_), let_in = 1 - glass_mean_;
        const double through = (eta_ > 1 ? let_in : let_in / (n * n)) * std::min(1.0, glass_beyond_->mean / glass_here_->mean);
        const double rest = (*glass_here_)(wo)*cosine / kPi *
                            (above ? (1 - through) * (*glass_here_)(wi) / glass_here_->mean
                                   : through * (*glass_beyond_)(wi) / glass_beyond_->mean / (eta_ * eta_));
        for (size_t c = 0; c < 3; ++c)
            f[c] += glass_ * (above ? dim(wo, wi, spread_) : dim_through(wo, wi)) * (lobe[c] + rest * (above ? 1 : color_[c]));
    }
    if (above && largest(sheen_) > 0) {
        const double fibres = sheen_kept_ * sheen_value(wo, wi, sheen_alpha_) * dim(wo, wi, 1, Layers::varnish);
        f = f + fibres * sheen_;
    }
    if (above && coat_ > 0 && coat_facets_.rough()) {
        const Vec h = normalized(wo + wi);
        const double varnish =
            coat_ * schlick(kCoat, dot(wo, h)) * coat_facets_.density(h) * coat_facets_.lit(wo, wi) / (4 * wo[2]);
        f = f + varnish * Vec{1, 1, 1};
    }
    return f;
}

// What draw() may do, each as often as the others.
struct PathLayers::Options {
    bool spread = true, both, facets, through, coat, smooth_coat, mirror, sheet, window;
    int count() const { return spread + facets + coat + smooth_coat + mirror + sheet + window; }
};
PathLayers::Options PathLayers::options() const {
    Options o{};
    o.spread = true;
    o.both = thin_ > 0 || glass_ > 0;
    o.facets = facets_.rough();
    o.through = o.facets && o.both;
    o.coat = coat_ > 0 && coat_facets_.rough();
    o.smooth_coat = coat_ > 0 && !coat_facets_.rough();
    o.mirror = !o.facets && metal_ + gloss_ > 0;
    o.sheet = !o.facets && thin_ > 0;
    o.window = !o.facets && glass_ > 0;
    return o;
}

double PathLayers::density(const Vec& wo, const Vec& wi) const {
    const Options o = options();
    double sum = o.both || wi[2] > 0 ? std::fabs(wi[2]) / kPi * (o.both ? 0.5 : 1) : 0;
    const auto normals = [](const Facets& facets, const Vec& h) { return facets.density(h) * h[2]; };
    const Vec up{wi[0], wi[1], std::fabs(wi[2])}, between = normalized(wo + up);
    const double half = o.through ? 0.5 : 1, straight = 1 / (4 * std::fabs(dot(wo, between)));
    if (o.facets && (wi[2] > 0 || thin_ > 0)) sum += half * normals(facets_, between) * straight;
    if (o.facets && wi[2] < 0 && glass_ > 0) {
        const Vec h = facet_between(wo, wi, eta_);
        const double to_facet = dot(wo, h), from_facet = dot(wi, h), bend = to_facet + eta_ * from_facet;
        if (to_facet > 0 && from_facet < 0) sum += half * normals(facets_, h) * eta_ * eta_ * -from_facet / (bend * bend);
    }
    if (o.coat && wi[2] > 0) sum += normals(coat_facets_, between) * straight;
    return sum / o.count();
}

Bounce PathLayers::draw(const Vec& wo, Dice& dice) const {
    const Options o = options();
    const Vec mirror{-wo[0], -wo[1], wo[2]};
    Bounce b;
    int pick = int(dice() * o.count());
    const auto is = [&](bool present) { return present && pick-- == 0; };
    const double below = (1 - coat_albedo(wo)) * (1 - sheen_albedo(wo)) * o.count();
    if (is(o.smooth_coat)) {
        const double sent = o.count() * coat_ * schlick(kCoat, wo[2]);
        return {mirror, {sent, sent, sent}, true};
    }
    if (is(o.mirror)) return {mirror, below * (metal_ * metal(wo[2]) + gloss_ * gloss(wo[2])), true};
    if (is(o.sheet)) {
        const Vec bare = gloss(wo[2]);
        for (size_t c = 0; c < 3; ++c) b.weight[c] = below * thin_ * color_[c] * (1 - bare[c]);
        return {-1 * wo, b.weight, true};
    }
    if (is(o.window)) {
        const Vec reflected = glass(wo[2], eta_);
        if (dice() < 0.5) return {mirror, 2 * below * glass_ * reflected, true};
        if (test::fresnel(wo[2], 1 / eta_) >= 1) return b;
        const Vec wi = normalized(test::refracted(-1 * wo, {0, 0, 1}, 1 / eta_));
        for (size_t c = 0; c < 3; ++c)
            b.weight[c] = 2 * o.count() * dim_through(wo, wi) * glass_ / (eta_ * eta_) * color_[c] * (1 - reflected[c]);
        return {wi, b.weight, true};
    }
    if (is(o.spread)) {
        b.wi = polar(std::sqrt(1 - dice()), 2 * kPi * dice());
        if (o.both && dice() < 0.5) b.wi[2] = -b.wi[2];
    } else {
        const bool is_coat = is(o.coat);
        const double u = dice();
        const Vec h = (is_coat ? coat_facets_ : facets_).normal(u, dice());
        const bool through = !is_coat && o.through && dice() < 0.5;
        b.wi = mirrored(wo, h);
        if (through && glass_ > 0) {
            if (dot(wo, h) <= 0 || test::fresnel(dot(wo, h), 1 / eta_) >= 1) return b;
            b.wi = normalized(test::refracted(-1 * wo, h, 1 / eta_));
            if (b.wi[2] >= 0) return b;
        } else {
            if (b.wi[2] <= 0) return b;
            if (through) b.wi[2] = -b.wi[2];
        }
    }
    const double p = density(wo, b.wi);
    if (p > 0) b.weight = 1 / p * value(wo, b.wi);
    return b;
}

}  // namespace clarity::reference
