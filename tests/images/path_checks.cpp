#include "images/path_checks.hpp"

#include <cmath>

#include "images/quick_scene.hpp"

namespace clarity::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

rt_material lambert(float albedo, float emission) {
    rt_material m = diffuse(albedo, albedo, albedo);
    m.model = RT_MODEL_LAMBERT;
    for (float& e : m.emission) e = emission;
    return m;
}

double geometric_sum(double q, int terms) {
    double sum = 0;
    for (int k = terms; k-- > 0;) sum = 1 + q * sum;
    return sum;
}

// Whether a picture without noise, or with little, has this value.
bool shows(const PathPicture& picture, double value) {
    return std::fabs(picture.average() - value) < 4 * picture.average_error() + 1e-5;
}

}  // namespace

double PathPicture::average() const {
    double sum = 0;
    for (size_t i = 1; i < mean.pixels.size(); i += 3) sum += mean.pixels[i];
    return sum / double(mean.pixels.size() / 3);
}

double PathPicture::deviation() const {
    const double middle = average();
    double sum = 0;
    for (size_t i = 1; i < mean.pixels.size(); i += 3) sum += (mean.pixels[i] - middle) * (mean.pixels[i] - middle);
    return std::sqrt(sum / double(mean.pixels.size() / 3 - 1));
}

double PathPicture::average_error() const {
    return deviation() / std::sqrt(double(mean.pixels.size() / 3));
}

PathPicture trace_paths(const Scene& scene, const View& view, unsigned samples, const Pairs& pairs) {
    Pairs all = {{"tracer", "path"}, {"accel", "bvh2"}, {"lanes", "4"}, {"packet", "8x8"}, {"size", "64x64"}};
    all.insert(all.end(), pairs.begin(), pairs.end());
    Settings settings = make_settings(all);
    const ScenePtr shared = shared_scene(with_all_of_textures(scene, view));
    Workbench& bench = Workbench::get();
    Progress progress;
    bench.frames().trace(*bench.prepare(shared, settings, view), settings, view, Samples(0, samples), false, progress);
    PathPicture picture;
    picture.mean = bench.frames().read_values();
    // The film's second plane: cl/tracers/path/sum.h.
    const unsigned width = picture.mean.width, height = picture.mean.height;
    FloatImage sums{width, 2 * height, 4, {}};
    sums.pixels.resize(size_t(width) * height * 8);
    bench.frames().read_sums(sums);
    picture.error = {width, height, 1, {}};
    for (size_t i = 0; i < size_t(width) * height; ++i) {
        const double count = sums.pixels[4 * i + 3], squares = sums.pixels[4 * (size_t(width) * height + i) + 3];
        picture.error.pixels.push_back(count > 1 ? float(std::sqrt(squares / (count - 1) / count)) : 0.0f);
    }
    return picture;
}

Scene hollow_sphere(float albedo, float emission) {
    Scene scene = scene_of(TriangleMesh());
    Sphere sphere;
    sphere.radius = 1;
    sphere.material = add_material(scene, lambert(albedo, emission));
    scene.spheres.push_back(sphere);
    return scene;
}

View inside_view(bool with_light) {
    View view = view_from({0.3f, 0.2f, 0.1f}, {-1, 0, 0}, 70);
    view.background = view.ambient = {0, 0, 0};
    if (with_light) {
        rt_light light{};
        light.kind = RT_LIGHT_POINT;
        light.flags = RT_LIGHT_FALLOFF;
        for (float& c : light.color) c = 1;
        view.lights = {light};
    }
    return view;
}

double hollow_sphere_radiance(double albedo, int depth) {
    return geometric_sum(albedo, depth + 1);
}

double lit_sphere_radiance(double albedo, int depth) {
    return albedo / kPi * geometric_sum(albedo, depth);
}

Scene sphere_over_floor() {
    Scene scene = scene_of(TriangleMesh());
    scene.planes.push_back({{0, 1, 0}, 0, add_material(scene, lambert(1, 0))});
    Sphere sphere;
    sphere.center = {1.2f, 1.5f, 0.3f};
    sphere.radius = 1;
    sphere.material = add_material(scene, lambert(0, 1));
    scene.spheres.push_back(sphere);
    return scene;
}

View floor_view() {
    View view = view_from({-3, 2, 0}, {0, 0, 0}, 0.01);
    view.background = view.ambient = {0, 0, 0};
    return view;
}

namespace {

// Whether the kernels in force pass a check, with this seed.
using Check = bool (*)(const std::string& seed);

PathPicture traced(const Scene& scene, const View& view, unsigned samples, Pairs pairs, const std::string& seed) {
    pairs.emplace_back("seed", seed);
    return trace_paths(scene, view, samples, pairs);
}

bool shows_at_depths(const Scene& scene, const View& view, double (*radiance)(double albedo, int depth),
                     const std::string& seed) {
    for (const int depth : {1, 2})
        if (!shows(traced(scene, view, 4, {{"depth", std::to_string(depth)}, {"size", "16x16"}}, seed), radiance(0.5, depth)))
            return false;
    return true;
}

bool counts_events(const std::string& seed) {
    return shows_at_depths(hollow_sphere(0.5f, 1), inside_view(false), hollow_sphere_radiance, seed);
}

bool asks_lights_at_the_last_event(const std::string& seed) {
    return shows_at_depths(hollow_sphere(0.5f, 0), inside_view(true), lit_sphere_radiance, seed);
}

bool ends_by_roulette(const std::string& seed) {
    return shows(traced(hollow_sphere(0.5f, 1), inside_view(false), 16, {{"depth", "64"}}, seed), 2) &&
           shows(traced(hollow_sphere(0.5f, 0), inside_view(true), 16, {{"depth", "64"}}, seed), 1 / kPi);
}

// A sun at a cosine of 0.6 over a white floor.
bool has_the_cosine(const std::string& seed) {
    View slanted = floor_view();
    rt_light sun{};
    sun.kind = RT_LIGHT_DIRECTIONAL;
    sun.position[0] = -0.8f, sun.position[1] = 0.6f;
    for (float& c : sun.color) c = 1;
    slanted.lights = {sun};
    return shows(traced(sphere_over_floor(), slanted, 1,
                        {{"depth", "1"}, {"only_by", "nee"}, {"size", "16x16"}, {"strategy", "bsdf"}}, seed),
                 0.6);
}

PathPicture lit_floor(const char* strategy, const std::string& seed) {
    return traced(sphere_over_floor(), floor_view(), 256, {{"depth", "1"}, {"sampler", "independent"}, {"strategy", strategy}},
                  seed);
}

bool finds_light_by_all_strategies(const std::string& seed) {
    for (const char* strategy : {"nee", "bsdf", "mis"})
        if (!shows(lit_floor(strategy, seed), kFloorRadiance)) return false;
    return true;
}

// (mean - truth) / error over pixels is a standard normal number.
bool knows_its_noise(const std::string& seed) {
    for (const char* strategy : {"nee", "bsdf", "mis"}) {
        const PathPicture floor = lit_floor(strategy, seed);
        double sum = 0, squares = 0;
        size_t known = 0;
        for (size_t i = 0; i < floor.error.pixels.size(); ++i) {
            if (!(floor.error.pixels[i] > 0)) continue;
            const double z = (floor.mean.pixels[3 * i + 1] - kFloorRadiance) / floor.error.pixels[i];
            sum += z, squares += z * z, ++known;
        }
        const double mean = sum / double(known), deviation = std::sqrt(squares / double(known) - mean * mean);
        if (known <= 4000 || !(deviation > 0.9 && deviation < 1.1)) return false;
    }
    return true;
}

// A plane seen from a slant, between a sky above and one below.
PathPicture plane_between(const rt_material& material, const Point& eye, float above, float below, const std::string& seed) {
    Scene scene = scene_of(TriangleMesh());
    scene.planes.push_back({{0, 1, 0}, 0, add_material(scene, material)});
    SkyValues& sky = scene.sky.values;
    sky.kind = RT_SKY_GRADIENT;
    for (int k = 0; k < 3; ++k) sky.color[k] = sky.horizon[k] = above, sky.ground[k] = below;
    View view = view_from(eye, {0, 0, 0}, 0.01);
    view.camera.up = {1, 0, 0};
    view.background = view.ambient = {0, 0, 0};
    return traced(scene, view, 64, {{"depth", "1"}, {"sampler", "independent"}}, seed);
}

// Glass spreads the light that is in it over a larger solid angle outside: (1 - R) L / ior^2.
bool bends_light(const std::string& seed) {
    rt_material clear = glass(1.5f);
    clear.model = RT_MODEL_DIELECTRIC;
    for (float& c : clear.color) c = 1;
    return shows(plane_between(clear, {0, 2, 0}, 0, 1, seed), 0.96 / 2.25);
}

// The albedo of GGX with alpha 0.25, once scattered, at a cosine of 0.5: by quadrature.
bool has_facets(const std::string& seed) {
    rt_material metal = diffuse(1, 1, 1);
    metal.model = RT_MODEL_CONDUCTOR;
    metal.roughness = 0.5f;
    metal.flags = RT_MATERIAL_SINGLE_SCATTER;
    const PathPicture seen = plane_between(metal, {1.7320508f, 1, 0}, 1, 0, seed);
    return std::fabs(seen.average() - 0.8573) < 4 * seen.average_error() + 1e-4 && seen.average_error() < 0.003;
}

const struct {
    const char* word;
    Check passes;
} kChecks[] = {{"depth", counts_events},
               {"last event", asks_lights_at_the_last_event},
               {"roulette", ends_by_roulette},
               {"cosine", has_the_cosine},
               {"directions", finds_light_by_all_strategies},
               {"noise", knows_its_noise},
               {"glass", bends_light},
               {"facets", has_facets}};

}  // namespace

std::vector<std::string> path_problems(int seed, const std::string& only) {
    std::vector<std::string> problems;
    for (const auto& check : kChecks)
        if ((only.empty() || only == check.word) && !check.passes(std::to_string(seed))) problems.emplace_back(check.word);
    return problems;
}

}  // namespace clarity::test
