#include "render/emitters/light_bound.hpp"

#include <algorithm>

namespace clarity {
namespace {

double angle_between(const Vec& a, const Vec& b) {
    return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
}

// A unit vector, turned towards another by an angle.
Vec turned(const Vec& axis, const Vec& towards, double angle) {
    const Vec beside = towards - dot(axis, towards) * axis;
    const double size = length(beside);
    return size > 1e-12 ? normalized(std::cos(angle) * axis + (std::sin(angle) / size) * beside) : axis;
}

void widen(LightBound& bound, const Vec& point) {
    for (size_t k = 0; k < 3; ++k) {
        bound.lower[k] = std::min(bound.lower[k], point[k]);
        bound.upper[k] = std::max(bound.upper[k], point[k]);
    }
}

}  // namespace

LightBound join(const LightBound& a, const LightBound& b) {
    LightBound out = a.spread >= b.spread ? a : b;
    const LightBound& other = a.spread >= b.spread ? b : a;
    for (size_t k = 0; k < 3; ++k) {
        out.lower[k] = std::min(a.lower[k], b.lower[k]);
        out.upper[k] = std::max(a.upper[k], b.upper[k]);
    }
    out.intensity = a.intensity + b.intensity;
    out.reach = std::max(a.reach, b.reach);
    out.two_sided = a.two_sided || b.two_sided;
    if (out.spread >= kPi) return out;
    // Where both sides count, a cone stands for the opposite one as well.
    const Vec axis = out.two_sided && dot(out.axis, other.axis) < 0 ? -1.0 * other.axis : other.axis;
    const double apart = angle_between(out.axis, axis);
    if (apart + other.spread <= out.spread) return out;
    const double spread = 0.5 * (out.spread + apart + other.spread);
    if (spread >= kPi) {
        out.spread = kPi;
        return out;
    }
    out.axis = turned(out.axis, axis, spread - out.spread);
    out.spread = spread;
    return out;
}

LightBound bound_of_ball(const Vec& middle, double radius) {
    LightBound bound;
    bound.lower = middle - Vec{radius, radius, radius};
    bound.upper = middle + Vec{radius, radius, radius};
    return bound;
}

LightBound bound_of_flat(const Vec* corners, size_t count, const Vec& normal) {
    LightBound bound;
    bound.lower = bound.upper = corners[0];
    for (size_t i = 1; i < count; ++i) widen(bound, corners[i]);
    if (length(normal) > 0) bound.axis = normalized(normal), bound.spread = 0;
    return bound;
}

bool bound_light(const rt_light& light, LightBound& out) {
    const Vec middle = to_vec(light.position), u = to_vec(light.u), v = to_vec(light.v), normal = to_vec(light.normal);
    const double disc = kPi * light.radius * double(light.radius);
    double facing = 1;  // area that is seen from where it shines straight to
    switch (light.kind) {
        case RT_LIGHT_POINT:
        case RT_LIGHT_SPOT:
            if (!(light.flags & RT_LIGHT_FALLOFF)) return false;
            out = bound_of_ball(middle, 0);
            if (light.kind == RT_LIGHT_POINT) break;
            out.axis = normal;
            out.spread = std::acos(std::clamp<double>(light.cos_inner, -1, 1));
            out.reach = std::acos(std::clamp<double>(light.cos_outer, -1, 1)) - out.spread;
            break;
        case RT_LIGHT_RECT: {
            const Vec corners[] = {middle + u + v, middle + u - v, middle - u + v, middle - u - v};
            out = bound_of_flat(corners, 4, normal);
            facing = 4 * length(cross(u, v));
            break;
        }
        case RT_LIGHT_DISC:
            out = bound_of_flat(&middle, 1, normal);
            for (size_t k = 0; k < 3; ++k) {
                const double half = light.radius * std::sqrt(std::max(0.0, 1 - normal[k] * normal[k]));
                out.lower[k] -= half;
                out.upper[k] += half;
            }
            facing = disc;
            break;
        case RT_LIGHT_SPHERE:
            out = bound_of_ball(middle, light.radius);
            facing = disc;
            break;
        default:
            return false;
    }
    out.two_sided = (light.flags & RT_LIGHT_TWO_SIDED) != 0;
    out.intensity = facing;
    return true;
}

}  // namespace clarity
