#include "reference/path.hpp"

#include <algorithm>
#include <stdexcept>

#include "base/angle.hpp"
#include "reference/path_surface.hpp"
#include "reference/world.hpp"

namespace clarity::reference {
namespace {

Vec times(const Vec& a, const Vec& b) {
    return {a[0] * b[0], a[1] * b[1], a[2] * b[2]};
}

// Any frame with z along n; with x along u and y on the side of v if these are given.
struct Axes {
    Vec x, y, z;
    Axes(const Vec& n, const Vec& u, const Vec& v) : Axes(n) {
        const Vec flat = u - dot(u, n) * n;
        if (!(length(flat) > 0)) return;
        x = normalized(flat);
        y = cross(n, x);
        if (dot(y, v) < 0) y = -1 * y;
    }
    explicit Axes(const Vec& n)
        : x(normalized(cross(std::fabs(n[0]) > 0.5 ? Vec{0, 1, 0} : Vec{1, 0, 0}, n))), y(cross(n, x)), z(n) {}
    Vec local(const Vec& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
    Vec world(const Vec& v) const { return v[0] * x + v[1] * y + v[2] * z; }
};

class PathTracer {
 public:
    PathTracer(const Scene& scene, const View& view, const PathLimits& limits)
        : scene_(scene), view_(view), depth_(limits.depth), bounce_(limits.bounce), world_(scene) {}

    Vec radiance(Ray ray, Dice& dice) const {
        Vec light{}, weight{1, 1, 1};
        const auto add = [&](unsigned events, const Vec& found) {
            if (bounce_ < 0 || int(events) == bounce_) light = light + times(weight, found);
        };
        bool asked = false;  // whether suns were asked at the last event
        for (unsigned event = 0;; ++event) {
            Hit hit;
            const bool met = world_.nearest(ray, hit);
            Vec emitted;
            if (meets_light(ray, met ? hit.t : INFINITY, emitted)) {
                add(event, emitted);
                return light;
            }
            if (!met) {
                add(event, sky(ray.direction));
                if (!asked) add(event, suns_seen(ray.direction));
                return light;
            }
            const MaterialValues& m = material(hit.material);
            const bool entering = dot(hit.geometric, ray.direction) < 0;
            if (!entering)
                for (size_t c = 0; c < 3; ++c) weight[c] *= std::exp(-double(m.absorption[c]) * hit.t);
            const Vec at = ray.at(hit.t), side = entering ? hit.geometric : -1 * hit.geometric;
            Vec normal = entering ? hit.shading : -1 * hit.shading;
            if (dot(normal, ray.direction) >= 0) normal = side;
            const Axes axes(normal, hit.along_u, hit.along_v);
            const Vec wo = axes.local(-1 * ray.direction);
            const PathSurface surface(m, color_at(m, at), entering);
            if (entering || !(m.flags & RT_MATERIAL_ONE_SIDED)) add(event, surface.shows(wo) * to_vec(m.emission));
            if (event == depth_) return light;
            for (const rt_light& l : view_.lights) add(event + 1, from_light(l, at, side, axes, surface, wo, dice));
            const Bounce bounce = surface.draw(wo, dice);
            if (std::max({bounce.weight[0], bounce.weight[1], bounce.weight[2]}) <= 0) return light;
            const Vec direction = normalized(axes.world(bounce.wi));
            if (dot(direction, side) * bounce.wi[2] <= 0) return light;  // smooth normals only: through the wrong side
            weight = times(weight, bounce.weight);
            asked = !bounce.delta;
            ray = leaving(at, bounce.wi[2] > 0 ? side : -1 * side, direction);
        }
    }

 private:
    const MaterialValues& material(unsigned i) const {
        return view_.materials.empty() ? scene_.materials[i].values : view_.materials[i];
    }
    Ray leaving(const Vec& at, const Vec& side, const Vec& direction, double distance = INFINITY) const {
        return {at + world_.offset(at) * side, direction, 0, distance};
    }
    static Vec color_at(const rt_material& m, const Vec& at) {
        const bool dark = m.flags & RT_MATERIAL_CHECKER && (long(std::floor(at[0])) + long(std::floor(at[2]))) % 2 != 0;
        return (dark ? 1.0 / 3 : 1.0) * to_vec(m.color);
    }
    static double sun_sine2(const rt_light& l) { return 1 - double(l.cos_outer) * l.cos_outer; }

    // The radiance of the nearest rect, disc or sphere that faces the ray before `limit`.
    bool meets_light(const Ray& ray, double limit, Vec& emitted) const {
        double nearest = limit;
        bool found = false;
        for (const rt_light& l : view_.lights) {
            double t = INFINITY;
            if (l.kind == RT_LIGHT_SPHERE) {
                t = test::hit_sphere(to_vec(l.position), l.radius, ray);
            } else if (l.kind == RT_LIGHT_RECT || l.kind == RT_LIGHT_DISC) {
                const Vec n = to_vec(l.normal);
                const double facing = dot(n, ray.direction);
                if (facing == 0 || (facing > 0 && !(l.flags & RT_LIGHT_TWO_SIDED))) continue;
                t = dot(n, to_vec(l.position) - ray.origin) / facing;
                const Vec from_middle = ray.at(t) - to_vec(l.position), u = to_vec(l.u), v = to_vec(l.v);
                const bool inside = l.kind == RT_LIGHT_DISC ? length(from_middle) <= l.radius
                                                            : std::fabs(dot(from_middle, u)) <= dot(u, u) &&
                                                                  std::fabs(dot(from_middle, v)) <= dot(v, v);
                if (!inside) continue;
            }
            if (!(std::isfinite(t) && t > 0 && t <= nearest)) continue;
            nearest = t;
            found = true;
            emitted = to_vec(l.color);
        }
        return found;
    }

    Vec sky(const Vec& d) const {
        const SkyValues& s = scene_.sky.values;
        if (s.kind == RT_NONE) return to_vec(view_.background);
        if (s.kind == RT_SKY_CONSTANT) return double(s.strength) * to_vec(s.color);
        if (s.kind == RT_SKY_GRADIENT)
            return double(s.strength) * (d[1] < 0 ? to_vec(s.ground) : d[1] * to_vec(s.color) + (1 - d[1]) * to_vec(s.horizon));
        // Bilinear between the middles of texels; around the zenith the picture has no end.
        const double turn = 0.5 + std::atan2(d[2], d[0]) / (2 * kPi) + s.rotate_deg / 360.0;
        const double x = turn * s.width - 0.5, y = std::acos(std::clamp(d[1], -1.0, 1.0)) / kPi * s.height - 0.5;
        const double column = std::floor(x), row = std::floor(y);
        Vec sum{};
        for (const int down : {0, 1})
            for (const int right : {0, 1}) {
                const auto at_x = size_t(long(column + right + 4.0 * s.width) % long(s.width));
                const auto at_y = size_t(std::clamp(row + down, 0.0, s.height - 1.0));
                const float* const texel = scene_.sky.texels.data() + 3 * (at_y * s.width + at_x);
                const double part = (right ? x - column : 1 - (x - column)) * (down ? y - row : 1 - (y - row));
                for (size_t k = 0; k < 3; ++k) sum[k] += part * s.strength * texel[k];
            }
        return sum;
    }

    Vec suns_seen(const Vec& direction) const {
        Vec sum{};
        for (const rt_light& l : view_.lights)
            if (l.kind == RT_LIGHT_SUN && dot(direction, normalized(to_vec(l.position))) > l.cos_outer)
                sum = sum + 1 / (kPi * sun_sine2(l)) * to_vec(l.color);
        return sum;
    }

    // Light that arrives straight from a light without a size, or from a sun, and leaves to wo.
    Vec from_light(const rt_light& l, const Vec& at, const Vec& side, const Axes& axes, const PathSurface& surface,
                   const Vec& wo, Dice& dice) const {
        Vec towards = to_vec(l.position);
        double distance = INFINITY, power = kPi;  // without falloff: an irradiance of pi times color
        if (l.kind == RT_LIGHT_POINT || l.kind == RT_LIGHT_SPOT) {
            towards = towards - at;
            distance = length(towards);
            if (l.flags & RT_LIGHT_FALLOFF) power = 1 / (distance * distance);
        } else if (l.kind == RT_LIGHT_DIRECTIONAL) {
            if (l.flags & RT_LIGHT_FALLOFF) power = 1;
        } else if (l.kind == RT_LIGHT_SUN) {
            const double z = 1 - dice() * (1 - double(l.cos_outer)), phi = 2 * kPi * dice(), r = std::sqrt(1 - z * z);
            towards = Axes(normalized(towards)).world({r * std::cos(phi), r * std::sin(phi), z});
            power = 2 * (1 - double(l.cos_outer)) / sun_sine2(l);  // solid angle times radiance for an irradiance of 1
        } else {
            return {};
        }
        towards = normalized(towards);
        if (l.kind == RT_LIGHT_SPOT) {
            const double c = -dot(towards, normalized(to_vec(l.normal)));
            const double part = std::clamp((c - l.cos_outer) / std::max(1e-3, double(l.cos_inner) - l.cos_outer), 0.0, 1.0);
            power *= part * part;  // as KHR_lights_punctual recommends
        }
        const Vec wi = axes.local(towards);
        const Vec f = surface.value(wo, wi);
        if (power <= 0 || dot(towards, side) * wi[2] <= 0 || std::max({f[0], f[1], f[2]}) <= 0) return {};
        if (world_.blocked(leaving(at, wi[2] > 0 ? side : -1 * side, towards, distance))) return {};
        return power * times(f, to_vec(l.color));
    }

    const Scene& scene_;
    const View& view_;
    const unsigned depth_;
    const int bounce_;
    const World world_;
};

}  // namespace

Vec PathPicture::total() const {
    Vec sum{};
    for (const Vec& v : mean) sum = sum + 1.0 / double(mean.size()) * v;
    return sum;
}
double PathPicture::total_error(int channel) const {
    double squares = 0;
    for (const Vec& e : error) squares += e[size_t(channel)] * e[size_t(channel)];
    return std::sqrt(squares) / double(error.size());
}

PathPicture trace_paths(const Scene& scene, const View& view, const PathLimits& limits) {
    for (const Material& m : scene.materials)
        if (m.values.texture != RT_NONE) throw std::invalid_argument("the reference knows no textures: " + m.name);
    const PathTracer tracer(scene, view, limits);
    const Vec eye = to_vec(view.camera.eye), w = normalized(to_vec(view.camera.target) - eye);
    const Vec u = normalized(cross(w, to_vec(view.camera.up))), v = cross(u, w);
    const double tangent = std::tan(0.5 * view.camera.fov_y_rad), aspect = double(limits.width) / limits.height;
    Dice dice(limits.seed);
    PathPicture picture{limits.width, limits.height, {}, {}};
    for (unsigned y = 0; y < limits.height; ++y)
        for (unsigned x = 0; x < limits.width; ++x) {
            Vec sum{}, squares{};
            for (unsigned s = 0; s < limits.samples; ++s) {
                const double right = (2 * (x + dice()) / limits.width - 1) * tangent * aspect;
                const double up = (1 - 2 * (y + dice()) / limits.height) * tangent;
                const Vec light = tracer.radiance({eye, normalized(w + right * u + up * v), 0, INFINITY}, dice);
                sum = sum + light;
                squares = squares + times(light, light);
            }
            const double n = limits.samples;
            Vec error;
            for (size_t c = 0; c < 3; ++c)
                error[c] = std::sqrt(std::max(0.0, squares[c] / n - sum[c] / n * sum[c] / n) / std::max(1.0, n - 1));
            picture.mean.push_back(1 / n * sum);
            picture.error.push_back(error);
        }
    return picture;
}

}  // namespace clarity::reference
