#include "whitted.hpp"

#include <algorithm>
#include <stdexcept>

#include "world.hpp"

namespace clarity::reference {
namespace {

class Tracer {
 public:
    Tracer(const Scene& scene, const View& view, const Settings& settings)
        : scene_(scene), view_(view), settings_(settings), world_(scene) {}

    // The light that comes back along a ray. weight: its share in the pixel; generation counts from 1.
    Vec trace(const Ray& ray, Vec weight, int generation) const {
        Hit hit;
        if (!world_.nearest(ray, INFINITY, hit)) return vec_of(view_.background);
        const rt_material& material = scene_.materials[hit.material].values;
        const Vec at = ray.origin + hit.t * ray.direction;

        // Seen from inside, normals are flipped. If the interpolated normal points away from the viewer, the geometric one
        // replaces it.
        const bool leaving = dot(hit.geometric, ray.direction) > 0;
        const Vec geometric = leaving ? -hit.geometric : hit.geometric;
        Vec normal = leaving ? -hit.shading : hit.shading;
        if (dot(normal, ray.direction) >= 0) normal = geometric;

        Vec light = direct_light(ray, at, geometric, normal, material);
        if (generation >= settings_.depth) return light;

        const double cos_in = std::min(1.0, -dot(normal, ray.direction));
        const double eta = leaving ? material.ior : 1 / double(material.ior);
        const double sin2_out = eta * eta * (1 - cos_in * cos_in);
        const double fresnel = sin2_out >= 1 ? 1 : reflectance(cos_in, std::sqrt(1 - sin2_out), eta);
        const double mirrored = material.reflect + material.refract * fresnel, refracted = material.refract * (1 - fresnel);

        if (mirrored * largest(weight) > settings_.min_weight) {
            Vec direction = ray.direction + 2 * cos_in * normal;
            // With an interpolated normal the direction may point into the surface: it is then mirrored out again.
            if (dot(direction, geometric) < 0) direction = direction - 2 * dot(direction, geometric) * geometric;
            light = light + mirrored * trace(leave(at, geometric, direction), mirrored * weight, generation + 1);
        }
        if (refracted * largest(weight) > settings_.min_weight) {
            const Vec direction = eta * ray.direction + (eta * cos_in - std::sqrt(1 - sin2_out)) * normal;
            const Vec share = refracted * color_at(material, at);
            light = light + share * trace(leave(at, -geometric, direction), share * weight, generation + 1);
        }
        return light;
    }

 private:
    Ray leave(Vec at, Vec side, Vec direction) const { return {at + world_.offset(at) * side, normalize(direction)}; }

    static Vec color_at(const rt_material& material, Vec at) {
        const Vec color = vec_of(material.color);
        const bool dark = material.flags & RT_MATERIAL_CHECKER && (long(std::floor(at.x)) + long(std::floor(at.z))) % 2 != 0;
        return dark ? (1.0 / 3) * color : color;
    }

    // Fresnel's equations; the mean of both polarisations.
    static double reflectance(double cos_in, double cos_out, double eta) {
        const double across = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
        const double along = (cos_in - eta * cos_out) / (cos_in + eta * cos_out);
        return 0.5 * (across * across + along * along);
    }

    // Emission, ambient light, Lambert's diffuse light for the share that is neither mirrored nor refracted, and Blinn's
    // highlight.
    Vec direct_light(const Ray& ray, Vec at, Vec geometric, Vec normal, const rt_material& material) const {
        Vec diffuse = vec_of(view_.ambient), highlight;
        for (const rt_light& light : view_.lights) {
            Vec towards = vec_of(light.position);
            double distance = INFINITY;
            if (light.kind == RT_LIGHT_POINT) {
                towards = towards - at;
                distance = length(towards);
            }
            towards = normalize(towards);
            if (dot(normal, towards) <= 0 || dot(geometric, towards) <= 0) continue;
            if (settings_.shadows && world_.blocked(leave(at, geometric, towards), distance)) continue;
            const double cosine = std::clamp(dot(normal, normalize(towards - ray.direction)), 0.0, 1.0);
            diffuse = diffuse + dot(normal, towards) * vec_of(light.color);
            highlight = highlight + std::pow(cosine, material.shininess) * vec_of(light.color);
        }
        const double share = std::max(0.0, 1.0 - material.reflect - material.refract);
        return vec_of(material.emission) + share * (color_at(material, at) * diffuse) + vec_of(material.specular) * highlight;
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
    const Camera& camera = view.camera;
    const Vec eye = vec_of(camera.eye), w = normalize(vec_of(camera.target) - eye);
    const Vec u = normalize(cross(w, vec_of(camera.up))), v = cross(u, w);
    const double tangent = std::tan(0.5 * camera.fov_y_rad), aspect = double(settings.width) / settings.height;

    FloatImage image;
    image.width = static_cast<unsigned>(settings.width);
    image.height = static_cast<unsigned>(settings.height);
    image.channels = 3;
    for (int y = 0; y < settings.height; ++y)
        for (int x = 0; x < settings.width; ++x) {
            const double right = (2 * (x + 0.5) / settings.width - 1) * tangent * aspect;
            const double up = (1 - 2 * (y + 0.5) / settings.height) * tangent;
            const Vec light = tracer.trace({eye, normalize(w + right * u + up * v)}, {1, 1, 1}, 1);
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
