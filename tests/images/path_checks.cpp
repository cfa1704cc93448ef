#include "images/path_checks.hpp"

#include <cmath>

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
    return std::fabs(picture.average() - value) < 4 * picture.average_error() + 1e-5 * value + 1e-6;
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
    Pairs all = {{"tracer", "path"}, {"lanes", "4"}, {"packet", "8x8"}, {"size", "64x64"}};
    all.insert(all.end(), pairs.begin(), pairs.end());
    Settings settings = make_settings(all);
    const ScenePtr shared = shared_scene(scene);
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

std::vector<std::string> path_problems(int seed) {
    std::vector<std::string> problems;
    const std::string seed_text = std::to_string(seed);
    const auto trace = [&](const Scene& scene, const View& view, unsigned samples, Pairs pairs) {
        pairs.emplace_back("seed", seed_text);
        return trace_paths(scene, view, samples, pairs);
    };
    const auto expect = [&](bool right, const char* what) {
        if (!right && (problems.empty() || problems.back() != what)) problems.emplace_back(what);
    };

    const Scene emitting = hollow_sphere(0.5f, 1), lit = hollow_sphere(0.5f, 0);
    for (const int depth : {1, 2})
        expect(shows(trace(emitting, inside_view(false), 4, {{"depth", std::to_string(depth)}, {"size", "16x16"}}),
                     hollow_sphere_radiance(0.5, depth)),
               "depth");
    for (const int depth : {1, 2})
        expect(shows(trace(lit, inside_view(true), 4, {{"depth", std::to_string(depth)}, {"size", "16x16"}}),
                     lit_sphere_radiance(0.5, depth)),
               "last event");
    expect(shows(trace(emitting, inside_view(false), 16, {{"depth", "64"}}), 2), "roulette");
    expect(shows(trace(lit, inside_view(true), 16, {{"depth", "64"}}), 1 / kPi), "roulette");

    View slanted = floor_view();
    rt_light sun{};
    sun.kind = RT_LIGHT_DIRECTIONAL;
    sun.position[0] = -0.8f, sun.position[1] = 0.6f;
    for (float& c : sun.color) c = 1;
    slanted.lights = {sun};
    const Pairs once = {{"depth", "1"}, {"only_by", "nee"}, {"size", "16x16"}, {"strategy", "bsdf"}};
    expect(shows(trace(sphere_over_floor(), slanted, 1, once), 0.6), "cosine");

    for (const char* strategy : {"nee", "bsdf", "mis"}) {
        const PathPicture floor =
            trace(sphere_over_floor(), floor_view(), 256, {{"depth", "1"}, {"sampler", "independent"}, {"strategy", strategy}});
        expect(std::fabs(floor.average() - kFloorRadiance) < 4 * floor.average_error() + 1e-5, "directions");
        double sum = 0, squares = 0;
        size_t known = 0;
        for (size_t i = 0; i < floor.error.pixels.size(); ++i) {
            if (!(floor.error.pixels[i] > 0)) continue;
            const double z = (floor.mean.pixels[3 * i + 1] - kFloorRadiance) / floor.error.pixels[i];
            sum += z, squares += z * z, ++known;
        }
        const double mean = sum / double(known), deviation = std::sqrt(squares / double(known) - mean * mean);
        expect(known > 4000 && deviation > 0.9 && deviation < 1.1, "noise");
    }
    return problems;
}

}  // namespace clarity::test
