// path_layers.hpp -- RT_MODEL_GLTF in double precision: the core of glTF 2.0 (appendix B) and KHR_materials_clearcoat, _sheen,
// _specular, _transmission, _volume, _ior, _anisotropy and _iridescence, layered so that light is kept, as docs/paths.md says.
// Albedos are integrated from the lobes themselves.
#pragma once
#include <memory>

#include "reference/path_facets.hpp"
#include "scene/scene.hpp"

namespace clarity::reference {

// One side of a surface, as PathSurface.
class PathLayers {
 public:
    // Surfaces that are known are not made again.
    static std::shared_ptr<const PathLayers> of(const MaterialValues& material, const Vec& color, bool entering);
    PathLayers(const MaterialValues& material, const Vec& color, bool entering);
    Vec value(const Vec& wo, const Vec& wi) const;
    Bounce draw(const Vec& wo, Dice& dice) const;
    double shows(const Vec& wo) const { return 1 - coat_albedo(wo); }

 private:
    struct Options;
    enum class Layers { varnish, all };
    double coat_albedo(const Vec& w) const;
    double sheen_albedo(const Vec& w) const;
    double gloss_albedo(const Vec& w) const;
    // By what the layers dim light that is below them; spread: 0, mirrored, to 1, spread by the cosine.
    double dim(const Vec& wo, const Vec& wi, double spread, Layers by = Layers::all) const;
    double dim_through(const Vec& wo, const Vec& wi) const;
    Vec metal(double cosine) const;  // reflectances of facets
    Vec gloss(double cosine) const;
    Vec glass(double cosine, double eta) const;
    Vec film(double cosine, const Vec& straight) const;
    Options options() const;
    double density(const Vec& wo, const Vec& wi) const;

    Vec color_, straight_{}, sheen_{};
    double metal_, gloss_, diffuse_, thin_, glass_, grazing_, most_, ior_, eta_;
    Facets facets_, coat_facets_;
    double spread_;  // of light that facets mirror, for dim()
    Over lost_, bent_, coat_lost_, coat_bent_, fibres_, glass_here_, glass_beyond_;
    Vec metal_again_{}, gloss_again_{};  // share of the lost light that comes back
    double inside_ = 0, glass_mean_ = 0, coat_, coat_mean_ = 0, sheen_mean_ = 0, sheen_alpha_ = 0, sheen_kept_ = 1;
    double film_, film_ior_, film_nm_;
};

}  // namespace clarity::reference
