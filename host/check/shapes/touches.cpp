#include "check/shapes/touches.hpp"

#include <algorithm>

namespace clarity::check {
namespace {

// Draws points about the box of a part.
class Around {
 public:
    Around(const ShapeSubject& subject, std::mt19937& random) : random_(random), size_(subject.size) {
        for (size_t k = 0; k < 3; ++k) {
            lo_[k] = subject.lo[k];
            hi_[k] = subject.hi[k];
        }
    }
    double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }
    // grown: the box's width and this share of the part's size on either side.
    Vec inside(double grown = 0) {
        Vec p;
        for (size_t k = 0; k < 3; ++k) p[k] = lo_[k] - grown * size_ + (hi_[k] - lo_[k] + 2 * grown * size_) * share();
        return p;
    }
    Vec beside() { return 0.5 * (lo_ + hi_) + size_ * (0.6 + 1.4 * share()) * random_direction(random_); }
    size_t axis() { return std::min<size_t>(static_cast<size_t>(3 * share()), 2); }
    double size() const { return size_; }

 private:
    std::mt19937& random_;
    const double size_;
    Vec lo_{}, hi_{};
};

}  // namespace

Vec across(const Vec& direction) {
    return normalized(cross(direction, std::fabs(direction[0]) < 0.6 * length(direction) ? Vec{1, 0, 0} : Vec{0, 1, 0}));
}

Vec random_direction(std::mt19937& random) {
    std::normal_distribution<double> normal;
    Vec v;
    do v = {normal(random), normal(random), normal(random)};
    while (dot(v, v) < 1e-6);
    return normalized(v);
}

rt_ray ray_of(const Vec& origin, const Vec& direction, double t_min) {
    rt_ray ray{};
    for (size_t k = 0; k < 3; ++k) {
        ray.origin[k] = static_cast<float>(origin[k]);
        ray.direction[k] = static_cast<float>(direction[k]);
    }
    ray.t_min = static_cast<float>(t_min);
    ray.t_max = INFINITY;
    return ray;
}

std::vector<rt_ray> rays_at(const ShapeSubject& subject, size_t count, std::mt19937& random) {
    Around around(subject, random);
    std::vector<rt_ray> rays;
    for (size_t i = 0; rays.size() < count; ++i) {
        const Vec target = around.inside();
        Vec from = around.beside(), along;
        switch (i % 6) {
            case 0:  // from inside of the box, in any direction
                from = around.inside();
                along = random_direction(random);
                break;
            case 1: {  // along an axis
                const size_t k = around.axis();
                along = {};
                along[k] = around.share() < 0.5 ? 1 : -1;
                from = target - 1.5 * around.size() * along;
                break;
            }
            case 2: {  // one component of the direction is 0
                const size_t k = around.axis();
                along = target - from;
                along[k] = 0;
                from = target - along;
                break;
            }
            case 3:  // past the box, where nothing may be
                along = around.inside(0.25) - from;
                break;
            default:
                along = target - from;
        }
        if (!(length(along) > 0)) continue;
        along = std::exp2(6 * around.share() - 3) * normalized(along);
        rays.push_back(ray_of(from, along, i % 7 == 3 ? -0.5 * around.size() / length(along) : 0));
    }
    return rays;
}

std::vector<Touch> touches_of(ShapeProbe& probe, const ShapeSubject& subject, const std::vector<rt_ray>& rays) {
    std::vector<Touch> touches;
    const auto add = [&](const std::vector<rt_ray>& asked, bool is_second) {
        const std::vector<ProbeHit> hits = probe.hits(subject, asked);
        for (size_t i = 0; i < asked.size(); ++i)
            if (is_hit(asked[i], hits[i])) {
                Touch touch{asked[i], hits[i], point_of(asked[i], hits[i].t)};
                touch.is_second = is_second;
                touches.push_back(touch);
            }
    };
    add(rays, false);
    const double step = neighbour_distance(subject);
    std::vector<rt_ray> behind;
    for (const Touch& touch : touches) {
        behind.push_back(touch.ray);
        behind.back().t_min = static_cast<float>(double(touch.hit.t) + 2 * step / length(to_vec(touch.ray.direction)));
    }
    add(behind, true);

    std::vector<rt_ray> neighbours;
    for (const Touch& touch : touches) {
        const Vec d = to_vec(touch.ray.direction), a = across(d), b = normalized(cross(d, a));
        for (const Vec& aside : {a, -1.0 * a, b, -1.0 * b}) {
            neighbours.push_back(
                ray_of(to_vec(touch.ray.origin) + step * aside, d, double(touch.hit.t) - 10 * step / length(d)));
        }
    }
    const std::vector<ProbeHit> beside = probe.hits(subject, neighbours);
    for (size_t i = 0; i < touches.size(); ++i) {
        Touch& touch = touches[i];
        const double d = length(to_vec(touch.ray.direction));
        Vec points[4];
        bool all = true;
        for (size_t k = 0; k < 4; ++k) {
            const size_t n = 4 * i + k;
            all =
                all && is_hit(neighbours[n], beside[n]) && std::fabs(double(beside[n].t) - double(touch.hit.t)) * d < 8 * step;
            points[k] = point_of(neighbours[n], beside[n].t);
        }
        if (!all) continue;
        const auto bend = [&](size_t k) {
            return std::fabs(double(beside[4 * i + k].t) + double(beside[4 * i + k + 1].t) - 2 * double(touch.hit.t)) * d;
        };
        if (bend(0) > 0.1 * step || bend(2) > 0.1 * step) continue;
        const Vec n = cross(points[0] - points[1], points[2] - points[3]);
        if (!(length(n) > 0)) continue;
        touch.across = normalized(n);
        touch.cosine = -dot(touch.across, to_vec(touch.ray.direction)) / d;
        if (touch.cosine < 0) {
            touch.across = -1.0 * touch.across;
            touch.cosine = -touch.cosine;
        }
        touch.is_smooth = touch.cosine > 0.15;
    }
    return touches;
}

}  // namespace clarity::check
