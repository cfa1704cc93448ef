#include "reference/whitted.hpp"

#include <algorithm>
#include <stdexcept>

#include "reference/world.hpp"

namespace clarity::reference {
namespace {

Vec product(const Vec& a, const Vec& b) {
    return {a[0] * b[0], a[1] * b[1], a[2] * b[2]};
}
double strongest(const Vec& a) {
    return std::max({a[0], a[1], a[2]});
}

class Tracer {
 public:
    Tracer(const Scene& scene, const View& view, const Settings& settings)
        : scene_(scene), view_(view), settings_(settings), world_(scene) {}

    // The light that comes back along a ray. weight: its share in the pixel; generation counts from 1.
    Vec trace(const Ray& ray, const Vec& weight, int generation) const {
        Hit hit;
        if (!world_.nearest(ray, hit)) return to_vec(view_.background);
        const rt_material& material = scene_.materials[hit.material].values;
        const Vec at = ray.at(hit.t);

        // Seen from inside, normals are flipped. If the interpolated normal points away from the viewer, the geometric one
        // replaces it.
        const bool leaving = dot(hit.geometric, ray.direction) > 0;
        const Vec geometric = leaving ? -1 * hit.geometric : hit.geometric;
        Vec normal = leaving ? -1 * hit.shading : hit.shading;
        if (dot(normal, ray.direction) >= 0) normal = geometric;

        Vec light = direct_light(ray, at, geometric, normal, material);
        if (generation >= settings_.depth) return light;

        const double cos_in = std::min(1.0, -dot(normal, ray.direction));
        const double eta = leaving ? material.ior : 1 / double(material.ior);
        const double fresnel = test::fresnel(cos_in, eta);
        const double mirrored = material.reflect + material.refract * fresnel, refracted = material.refract * (1 - fresnel);

        if (mirrored * strongest(weight) > number_of(settings_, "min_weight")) {
            Vec direction = ray.direction + 2 * cos_in * normal;
            // With an interpolated normal the direction may point into the surface: it is then mirrored out again.
            if (dot(direction, geometric) < 0) direction = direction - 2 * dot(direction, geometric) * geometric;
            light = light + mirrored * trace(leave(at, geometric, direction), mirrored * weight, generation + 1);
        }
        if (refracted * strongest(weight) > number_of(settings_, "min_weight")) {
            const Vec share = refracted * color_at(material, at);
            const Ray inside = leave(at, -1 * geometric, test::refracted(ray.direction, normal, eta));
            light = light + product(share, trace(inside, product(share, weight), generation + 1));
        }
        return light;
    }

 private:
    Ray leave(const Vec& at, const Vec& side, const Vec& direction, double distance = INFINITY) const {
        return {at + world_.offset(at) * side, normalized(direction), 0, distance};
    }

    static Vec color_at(const rt_material& material, const Vec& at) {
        const Vec color = to_vec(material.color);
        const bool dark = material.flags & RT_MATERIAL_CHECKER && (long(std::floor(at[0])) + long(std::floor(at[2]))) % 2 != 0;
        return dark ? (1.0 / 3) * color : color;
    }

    // Emission, ambient light, Lambert's diffuse light for the share that is neither mirrored nor refracted, and Blinn's
    // highlight.
    Vec direct_light(const Ray& ray, const Vec& at, const Vec& geometric, const Vec& normal,
                     const rt_material& material) const {
        Vec diffuse = to_vec(view_.ambient), highlight{};
        for (const rt_light& light : view_.lights) {
            Vec towards = to_vec(light.position);
            double distance = INFINITY;
            if (light.kind == RT_LIGHT_POINT) {
                towards = towards - at;
                distance = length(towards);
            }
            towards = normalized(towards);
            if (dot(normal, towards) <= 0 || dot(geometric, towards) <= 0) continue;
            if (settings_.shadows && world_.blocked(leave(at, geometric, towards, distance))) continue;
            const double cosine = std::clamp(dot(normal, normalized(towards - ray.direction)), 0.0, 1.0);
            diffuse = diffuse + dot(normal, towards) * to_vec(light.color);
            highlight = highlight + std::pow(cosine, material.shininess) * to_vec(light.color);
        }
        const double share = std::max(0.0, 1.0 - material.reflect - material.refract);
        return to_vec(material.emission) + share * product(color_at(material, at), diffuse) +
               product(to_vec(material.specular), highlight);
    }

    const Scene& scene_;
    const View& view_;
    const Settings& settings_;
    const World world_;
};

}  // namespace

FloatImage render(const Scene& scene, const View& view, const Settings& settings) {
    for (const Material& material : scene.materials)
        if (material.values.texture != RT_NONE)
            throw std::invalid_argument("the reference knows no textures: " + material.name);
    const Tracer tracer(scene, view, settings);
    FloatImage image;
    image.width = static_cast<unsigned>(settings.width);
    image.height = static_cast<unsigned>(settings.height);
    image.channels = 3;
    for (int y = 0; y < settings.height; ++y)
        for (int x = 0; x < settings.width; ++x) {
            const Ray ray = test::camera_ray(view.camera, settings.width, settings.height, x, y);
            const Vec light = tracer.trace(ray, {1, 1, 1}, 1);
            for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<float>(light[c]));
        }
    return image;
}

ByteImage to_display(const FloatImage& linear) {
    std::vector<uint8_t> pixels;
    for (size_t i = 0; i < linear.pixels.size(); ++i) {
        const double c = std::clamp(double(linear.pixels[i]), 0.0, 1.0);
        const double s = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
        pixels.push_back(static_cast<uint8_t>(255 * s + 0.5));
        if (i % 3 == 2) pixels.push_back(255);
    }
    return {linear.width, linear.height, std::move(pixels)};
}

}  // namespace clarity::reference
