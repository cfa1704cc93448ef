// path_layers_test.cpp -- surfaces of glTF, traced by `path` and by the reference in double precision, which shares no line
// with the kernels: means agree, and a fault of each lobe is found.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "images/optics.hpp"
#include "images/path_checks.hpp"
#include "reference/path.hpp"
#include "scene/tangents.hpp"
#include "support/planted_faults.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr unsigned kSide = 16;

struct LayersScene {
    const char* name;
    float roughness;
    std::function<void(MaterialValues&)> change;
    bool grazing = false;  // seen at an angle of 1.4 degrees, where fine fibres send back most
    friend void PrintTo(const LayersScene& scene, std::ostream* out) { *out << scene.name; }
};

void varnish(MaterialValues& m) {
    m.layers.clearcoat = 0.9f;
    m.layers.clearcoat_roughness = 0.35f;
}
void fibres(MaterialValues& m) {
    m.layers.sheen_color[0] = 0.9f, m.layers.sheen_color[1] = 0.6f, m.layers.sheen_color[2] = 0.3f;
    m.layers.sheen_roughness = 0.6f;
}
void metal(MaterialValues& m) {
    m.layers.metallic = 1;
}
void film(MaterialValues& m) {
    m.layers.iridescence = 0.9f;
}
void grain(MaterialValues& m) {
    m.layers.anisotropy = 0.6f;
    m.layers.anisotropy_rotation = 30;
}
void sheet(MaterialValues& m) {
    m.layers.transmission = 0.8f;
}
void solid(MaterialValues& m) {
    m.layers.transmission = 0.9f;
    m.layers.flags = RT_LAYERS_SOLID;
    m.absorption[0] = 0.8f;
}

// The square of optics.hpp and a ball above it, both of the material; of solids the square is white.
const LayersScene kScenes[] = {
    {"Core", 0.4f, [](MaterialValues&) {}},
    {"Metal", 0.6f, metal},
    {"Weight", 0.3f, [](MaterialValues& m) { m.layers.specular_weight = 0.4f, m.layers.specular_color[2] = 8; }},
    {"Varnish", 0.6f, varnish},
    {"SmoothVarnish", 0.5f, [](MaterialValues& m) { m.layers.clearcoat = 1; }},
    {"Glow", 0.5f, [](MaterialValues& m) { varnish(m), m.emission[0] = m.emission[1] = 0.6f; }},
    {"Fibres", 0.7f, fibres},
    {"FineFibres", 0.7f,
     [](MaterialValues& m) {
         fibres(m), m.layers.sheen_roughness = 0.12f, m.layers.specular_weight = 0;
         for (float& c : m.color) c = 0;
     },
     true},
    {"Sheet", 0.35f, sheet},
    {"SmoothSheet", 0, sheet},
    {"Solid", 0.3f, solid},
    {"SmoothSolid", 0,
     [](MaterialValues& m) { solid(m), varnish(m), m.layers.specular_weight = 0.4f, m.layers.specular_color[1] = 20; }},
    {"Film", 0.3f, [](MaterialValues& m) { film(m), metal(m); }},
    {"Grain", 0.3f, [](MaterialValues& m) { grain(m), metal(m); }},
    {"All", 0.4f, [](MaterialValues& m) { varnish(m), fibres(m), film(m), grain(m), sheet(m), m.layers.metallic = 0.4f; }},
};

Scene scene_of_layers(const LayersScene& of) {
    Scene scene = white_square();
    MaterialValues m = default_material();
    m.model = RT_MODEL_GLTF;
    m.roughness = of.roughness;
    m.color[0] = 0.9f, m.color[1] = 0.6f, m.color[2] = 0.3f;
    m.ior = 1.5f;
    of.change(m);
    Sphere ball;
    ball.center = {1.1f, 0.9f, 0.55f};
    ball.radius = 0.4f;
    ball.material = rt_u32(scene.materials.size());
    scene.materials.push_back({"layers", m});
    const bool is_solid = (m.layers.flags & RT_LAYERS_SOLID) != 0, has_grain = m.layers.anisotropy > 0;
    if (!is_solid) scene.materials[0].values = m;
    if (!has_grain) scene.spheres.push_back(ball);  // a ball has no coordinates that its grain could follow
    if (has_grain) make_tangents(scene);
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_GRADIENT;
    for (size_t k = 0; k < 3; ++k) sky.color[k] = 0.4f + 0.3f * float(k), sky.horizon[k] = 1, sky.ground[k] = 0.2f;
    return scene;
}

View view_of_layers(const LayersScene& of) {
    View view = of.grazing ? view_from({1, -6, 0.17f}, {1, 1, 0}, 0.4) : view_from({1, -1.6f, 1.7f}, {1, 0.9f, 0.2f}, 45);
    view.background = view.ambient = {0, 0, 0};
    rt_light lamp{};
    lamp.kind = RT_LIGHT_RECT;
    lamp.position[0] = 2.5f, lamp.position[1] = 2, lamp.position[2] = 3;
    lamp.u[0] = lamp.v[1] = 1;  // u x v is up: it shines both ways
    lamp.normal[2] = 1;
    lamp.area = 4;
    lamp.flags = RT_LIGHT_TWO_SIDED;
    for (float& c : lamp.color) c = 4;
    view.lights = {lamp};
    return view;
}

struct Means {
    Vec value{}, error{};
};
Means reference_means(const LayersScene& of, unsigned samples) {
    const reference::PathPicture picture =
        reference::trace_paths(scene_of_layers(of), view_of_layers(of), {kSide, kSide, 3, samples});
    Means m{picture.total(), {}};
    for (int c = 0; c < 3; ++c) m.error[size_t(c)] = picture.total_error(c);
    return m;
}
Means traced_means(const LayersScene& of, unsigned samples, const char* strategy) {
    const PathPicture picture =
        trace_paths(scene_of_layers(of), view_of_layers(of), samples,
                    {{"strategy", strategy}, {"sampler", "independent"}, {"depth", "3"}, {"size", "16x16"}, {"seed", "7"}});
    Means m;
    double squares = 0;
    for (const float e : picture.error.pixels) squares += double(e) * e / std::pow(kSide, 4);
    for (size_t i = 0; i < picture.mean.pixels.size(); ++i) m.value[i % 3] += picture.mean.pixels[i] / double(kSide * kSide);
    const double luminance = 0.2126 * m.value[0] + 0.7152 * m.value[1] + 0.0722 * m.value[2];
    for (size_t c = 0; c < 3; ++c) m.error[c] = std::sqrt(squares) * m.value[c] / luminance;
    return m;
}

// How many standard errors the worst channel is off; what tables and fits round is left out.
double misfit(const Means& a, const Means& b) {
    double worst = 0;
    for (size_t c = 0; c < 3; ++c) {
        const double off = std::max(0.0, std::fabs(a.value[c] - b.value[c]) - 0.001 * b.value[c]);
        worst = std::max(worst, off / std::hypot(a.error[c], b.error[c]));
    }
    return worst;
}

const LayersScene& scene_named(const std::string& name) {
    for (const LayersScene& scene : kScenes)
        if (name == scene.name) return scene;
    throw std::logic_error("no scene " + name);
}

class PathLayers : public testing::TestWithParam<LayersScene> {};

TEST_P(PathLayers, AreThoseOfTheReference) {
    const unsigned samples = quick() ? 400 : 3000;
    const double bound = quick() && GetParam().grazing ? 0.03 : 0.012;
    const Means wanted = reference_means(GetParam(), samples);
    for (const char* strategy : {"mis", "bsdf"}) {
        const Means found = traced_means(GetParam(), samples, strategy);
        EXPECT_LT(misfit(found, wanted), 4)
            << strategy << ": " << found.value[0] << " " << found.value[1] << " " << found.value[2] << " instead of "
            << wanted.value[0] << " " << wanted.value[1] << " " << wanted.value[2];
        for (size_t c = 0; c < 3; ++c)
            EXPECT_LT(std::hypot(found.error[c], wanted.error[c]), bound * wanted.value[c])
                << strategy << ": the bound tells nothing";
    }
}

INSTANTIATE_TEST_SUITE_P(All, PathLayers, testing::ValuesIn(kScenes),
                         [](const testing::TestParamInfo<LayersScene>& info) { return std::string(info.param.name); });

struct LayersFault {
    const char *name, *file, *sound, *faulty;
    const char* scene;  // that must find it
    friend void PrintTo(const LayersFault& fault, std::ostream* out) { *out << fault.name; }
};
const LayersFault kLayersFaults[] = {
    {"FacetsWithoutShadows", "shading/layer_lobes.h", "return seen / (smith_o + smith_i);", "return seen * rt_vfloat(0.5f);",
     "Metal"},
    {"DiffuseBelowNothing", "shading/layer_lobes.h", "l->diffuse * l->inside * (one - o->gloss) * (one - i.gloss)",
     "l->diffuse", "Core"},
    {"WeightOfAllIsOne", "shading/layers.h", "l.grazing = m->specular_weight;", "l.grazing = one;", "Weight"},
    {"VarnishOfTwiceItsReflectance", "shading/layers.h", "#define RT_COAT_STRAIGHT 0.04f", "#define RT_COAT_STRAIGHT 0.08f",
     "SmoothVarnish"},
    {"VarnishDimsNothing", "shading/layers.h", "return rt_below(o->coat, i->coat, l->coat_mean, spread);",
     "return rt_vfloat(1.0f);", "Varnish"},
    {"VarnishLetsAllGlowOut", "shading/layers.h", "return one - rt_coat_albedo(coat, alpha, rt_min(fabs(cosine), one));",
     "return one;", "Glow"},
    {"SheenUnnormalised", "shading/sheen.h", "return rt_from_pair(rt_sheen_kept, r.low, r.share) * facing", "return facing",
     "FineFibres"},
    {"SheenWithoutShadows", "shading/sheen.h", "one + rt_sheen_smith(wo.z, t) + rt_sheen_smith(wi.z, t)",
     "one + rt_sheen_smith(wo.z, t)", "Fibres"},
    {"SheetOfClearColor", "shading/layer_lobes.h", "rt_scale(l->thin, rt_mul(l->color, rt_rest(gloss))));\n        f =",
     "rt_scale(l->thin, rt_rest(gloss)));\n        f =", "Sheet"},
    {"GlassHeedsNoWeight", "shading/layers.h", "rt_choose(l->changed & RT_MASK(exact < one), changed,",
     "rt_choose(rt_vint(0), changed,", "SmoothSolid"},
    {"FilmOfTwiceItsThickness", "shading/film.h", "rt_vfloat(2.0f * 2.0f * RT_PI * 1e-9f)",
     "rt_vfloat(4.0f * 2.0f * RT_PI * 1e-9f)", "Film"},
    {"GrainLiesAcross", "shading/bsdf_of.h", "out->grain_y = rt_select(mine, sine, out->grain_y);",
     "out->grain_x = rt_select(mine, sine, out->grain_x), out->grain_y = rt_select(mine, -cosine, out->grain_y);", "Grain"},
    {"FibresDimNothing", "shading/layers.h", "dim *= rt_below(o->sheen, i->sheen, l->sheen_mean, spread);", "", "Fibres"},
};

class PathLayersFaults : public testing::TestWithParam<LayersFault> {};

TEST_P(PathLayersFaults, IsFound) {
    constexpr unsigned kSamples = 2000;
    const LayersFault& fault = GetParam();
    const Means wanted = reference_means(scene_named(fault.scene), kSamples);
    const FaultyKernel planted(fault.file, fault.sound, fault.faulty);
    EXPECT_GT(misfit(traced_means(scene_named(fault.scene), kSamples, "mis"), wanted), 4);
}

INSTANTIATE_TEST_SUITE_P(All, PathLayersFaults, testing::ValuesIn(kLayersFaults),
                         [](const testing::TestParamInfo<LayersFault>& info) { return std::string(info.param.name); });

}  // namespace
