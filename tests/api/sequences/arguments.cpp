#include "arguments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sequences {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Ray drawn_ray(Draw& draw, const World& world, double far) {
    Ray ray;
    double at[3];
    for (int k = 0; k < 3; ++k) {
        ray.origin[k] = far + world.size * draw.real(-1.5, 2.5);
        at[k] = far + world.size * draw.real();
    }
    const double length = draw.chance(0.3) ? draw.real(0.05, 10) : 1;
    const bool astray = draw.chance(0.2), along_axis = draw.chance(0.1);
    const size_t axis = draw.below(3);
    for (size_t k = 0; k < 3; ++k) {
        ray.direction[k] = length * (astray ? world.size * draw.real(-1, 1) : at[k] - ray.origin[k]);
        if (along_axis && k != axis) ray.direction[k] = 0;
        if (along_axis && k != axis) ray.origin[k] = at[k];
    }
    ray.t_max = kInfinity;
    return ray;
}

// Numbers that no ray should have.
void spoil(Draw& draw, Ray& ray) {
    const double odd = draw.one_of({std::nan(""), kInfinity, -kInfinity, 0.0, 1e-40, -1e-320, 1e38, -1e300, 1e-24});
    const size_t k = draw.below(3);
    switch (draw.below(5)) {
        case 0:
            ray.origin[k] = odd;
            break;
        case 1:
            ray.direction = {odd, odd, odd};
            break;
        case 2:
            ray.direction = {0, 0, 0};
            ray.direction[k] = odd;
            break;
        case 3:
            ray.t_min = odd;
            break;
        default:
            ray.t_max = odd;
    }
}

}  // namespace

size_t some_count(Draw& draw) {
    if (draw.chance(0.9)) return draw.below(24);
    return draw.chance(0.97) ? draw.below(300) : draw.one_of({4095u, 4096u, 5000u, 16384u, 16385u, 40000u});
}

RayArrays::RayArrays(Draw& draw, const World& world, double far, size_t count) : given{}, rays(count) {
    const bool is_double = draw.chance(far != 0 ? 0.9 : 0.3);
    const bool one_origin = draw.chance(0.15), one_direction = draw.chance(0.1), one_limit = draw.chance(0.3);
    const bool has_min = draw.chance(0.3), has_max = draw.chance(0.3);
    for (size_t i = 0; i < count; ++i) {
        Ray& ray = rays[i];
        ray = drawn_ray(draw, world, far);
        if (has_min) ray.t_min = draw.chance(0.5) ? 0 : draw.real(0, 1);
        if (has_max) ray.t_max = draw.chance(0.3) ? kInfinity : draw.real(0, 2);
        if (draw.chance(0.02)) spoil(draw, ray);
        if (one_origin) ray.origin = rays[0].origin;
        if (one_direction) ray.direction = rays[0].direction;
        if (one_limit) ray.t_min = rays[0].t_min, ray.t_max = rays[0].t_max;
        if (!has_min) ray.t_min = 0;
        if (!has_max) ray.t_max = kInfinity;
    }
    // As they are given, and as the library reads them: floats, and doubles, of which it rounds directions and limits.
    const auto given_as = [&](double x) { return is_double ? x : double(float(x)); };
    std::vector<double> origins, directions, t_min, t_max;
    for (Ray& ray : rays) {
        for (int k = 0; k < 3; ++k) {
            origins.push_back(ray.origin[k] = given_as(ray.origin[k]));
            directions.push_back(ray.direction[k]);
            ray.direction[k] = float(ray.direction[k]);
        }
        t_min.push_back(ray.t_min);
        t_max.push_back(ray.t_max);
        ray.t_min = float(ray.t_min), ray.t_max = float(ray.t_max);
        double largest = 0;
        for (int k = 0; k < 3; ++k) {
            largest = std::max(largest, std::abs(ray.direction[k]));
            ray.known &= std::abs(ray.origin[k] - far) < 1e3 * world.size && std::abs(ray.direction[k]) < 1e6 * world.size;
        }
        ray.known &= largest > 1e-6 * world.size && ray.t_min >= 0 && !std::isnan(ray.t_max);
    }
    given.struct_bytes = sizeof given;
    given.type = is_double ? CLARITY_FLOAT64 : CLARITY_FLOAT32;
    given.count = count;
    given.origins = lay_out(draw, origins, 3, one_origin, given.origin_steps);
    given.directions = lay_out(draw, directions, 3, one_direction, given.direction_steps);
    int64_t steps[2] = {};
    if (has_min) given.t_min = lay_out(draw, t_min, 1, one_limit, steps);
    given.t_min_step = steps[0];
    if (has_max) given.t_max = lay_out(draw, t_max, 1, one_limit, steps);
    given.t_max_step = has_max ? steps[0] : 0;
    given.mask = draw.chance(0.2) ? static_cast<uint32_t>(1 + draw.below(255)) : 0;  // instances of ours have all bits
}

const void* RayArrays::lay_out(Draw& draw, const std::vector<double>& numbers, size_t width, bool one_for_all, int64_t* steps) {
    const bool is_double = given.type == CLARITY_FLOAT64;
    const int64_t bytes = is_double ? 8 : 4,
                  count = one_for_all ? std::min<int64_t>(1, int64_t(rays.size())) : int64_t(rays.size());
    // Numbers of a ray side by side or with anything between them, rays one behind the other, with gaps, or backwards.
    int64_t inner = draw.chance(0.7) ? bytes : bytes + int64_t(draw.below(9));
    int64_t outer = int64_t(width) * inner + (draw.chance(0.7) ? 0 : int64_t(draw.below(21)));
    const int64_t extent = count == 0 ? 0 : (count - 1) * outer + (int64_t(width) - 1) * inner + bytes;
    Bytes& memory = arrays_[arrays_made_++] = Bytes(size_t(extent));
    char* begin = memory.as<char>();
    if (count > 0 && draw.chance(0.1)) begin += (int64_t(width) - 1) * inner, inner = -inner;
    if (count > 0 && draw.chance(0.1)) begin += (count - 1) * outer, outer = -outer;
    for (int64_t i = 0; i < count; ++i)
        for (int64_t k = 0; k < int64_t(width); ++k) {
            const double number = numbers[size_t(i) * width + size_t(k)];
            const float rounded = float(number);
            std::memcpy(begin + i * outer + k * inner, is_double ? static_cast<const void*>(&number) : &rounded, size_t(bytes));
        }
    steps[0] = one_for_all ? 0 : outer;
    if (width > 1) steps[1] = inner;
    return begin;
}

// Positions as numbers of a type, and what the library makes of them.
Bytes positions_as(bool is_double, std::vector<Point>& positions) {
    Bytes bytes(positions.size() * 3 * (is_double ? 8 : 4));
    for (size_t i = 0; i < positions.size(); ++i)
        for (size_t k = 0; k < 3; ++k) {
            if (is_double)
                bytes.as<double>()[3 * i + k] = positions[i][k];
            else
                positions[i][k] = bytes.as<float>()[3 * i + k] = float(positions[i][k]);
        }
    return bytes;
}

Watch::Watch(Draw& draw, bool may) : kind(drawn(draw, may)), watch_(draw, clarity_watch{}) {
    clarity_watch& watch = *watch_.get();
    *cancel_.as<int32_t>() = kind == Kind::cancelled ? 1 : 0;
    if (kind == Kind::cancels_soon) left_ = static_cast<int>(draw.below(4));
    if (kind == Kind::wrong) watch_.spoil(draw.one_of({0u, 1u, 8u, uint32_t(sizeof watch - 1)}));
    if (kind == Kind::cancels_soon || draw.chance(0.7)) watch.progress = tell;
    if (kind == Kind::cancelled || draw.chance(0.5)) watch.cancel = cancel_.as<int32_t>();
    watch.user = this;
}

Watch::Kind Watch::drawn(Draw& draw, bool may) {
    if (draw.chance(0.6)) return Kind::none;
    if (!may || draw.chance(0.7)) return Kind::looks_on;
    return draw.one_of({Kind::cancelled, Kind::cancels_soon, Kind::wrong});
}

void Watch::ended(const Step& step, int32_t code, bool done_at_once) const {
    switch (kind) {
        case Kind::wrong:
            return step.ended(code, CLARITY_USAGE, "clarity_watch::struct_bytes");
        case Kind::cancelled:
            return step.ended(code, CLARITY_CANCELLED, "", done_at_once);
        case Kind::cancels_soon:
            return step.ended(code, CLARITY_CANCELLED, "", true);
        default:
            step.ended(code);
    }
}

int32_t Watch::tell(void* user, const char* stage, float fraction) {
    // A text that has gone, and a fraction that is none, are seen here.
    if (std::strlen(stage) > 1000 || !(fraction <= 1)) std::abort();
    return --static_cast<Watch*>(user)->left_ >= 0;
}

}  // namespace sequences
