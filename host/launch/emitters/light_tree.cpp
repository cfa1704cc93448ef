#include "launch/emitters/light_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace clarity {
namespace {

constexpr int kBins = 12;
// Added to the angles of cones, in radians, since their cosines are rounded to floats.
constexpr double kSlack = 1e-3;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The solid angle that light of a cone goes into, weighted by the cosine beyond it (equation 1 of the paper).
double orientation_cost(const LightBound& b) {
    const double o = b.spread, w = std::min(o + b.reach, kPi);
    return 2 * kPi * (1 - std::cos(o)) +
           kPi / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
}
// The area of the box, and its squared diagonal, for the box of lights in a row has no area.
double size_cost(const LightBound& b) {
    const Vec d = b.upper - b.lower;
    return 2 * (d[0] * d[1] + d[1] * d[2] + d[2] * d[0]) + dot(d, d);
}
double cost(const LightBound& b) {
    return b.intensity * orientation_cost(b) * size_cost(b);
}

double middle(const LightBound& b, int axis) {
    return 0.5 * (b.lower[size_t(axis)] + b.upper[size_t(axis)]);
}

struct Split {
    double cost = kInfinity;
    int axis = 0, bin = 0;  // the bins up to this one go to the first child
};

// The bins of middles along an axis.
struct Bins {
    double low, scale;
    int operator()(double at) const { return std::min(kBins - 1, int((at - low) * scale)); }
};

class Builder {
 public:
    Builder(const std::vector<LightBound>& bounds, std::vector<rt_u32>& leaves) : bounds_(bounds), leaves_(leaves) {
        order_.resize(bounds.size());
        std::iota(order_.begin(), order_.end(), size_t(0));
        leaves_.assign(bounds.size(), RT_NONE);
    }

    std::vector<rt_light_node> build() {
        struct Task {
            size_t begin, end;
            rt_u32 node;
        };
        std::vector<Task> tasks;
        if (!order_.empty()) {
            nodes_.reserve(2 * order_.size());
            nodes_.emplace_back().parent = RT_NONE;
            tasks.push_back({0, order_.size(), 0});
        }
        double all = 1;
        while (!tasks.empty()) {
            const Task task = tasks.back();
            tasks.pop_back();
            const LightBound bound = joined(task.begin, task.end);
            if (task.node == 0) all = bound.intensity;
            write(task.node, bound, all);
            if (task.end - task.begin == 1) {
                nodes_[task.node].emitter = bound.emitter;
                leaves_[order_[task.begin]] = task.node;
                continue;
            }
            const size_t half = divide(task.begin, task.end, bound);
            const auto child = rt_u32(nodes_.size());
            nodes_[task.node].child = child;
            for (int k = 0; k < 2; ++k) nodes_.emplace_back().parent = task.node;
            tasks.push_back({half, task.end, child + 1});
            tasks.push_back({task.begin, half, child});
        }
        return std::move(nodes_);
    }

 private:
    const LightBound& at(size_t i) const { return bounds_[order_[i]]; }

    LightBound joined(size_t begin, size_t end) const {
        LightBound all = at(begin);
        for (size_t i = begin + 1; i < end; ++i) all = join(all, at(i));
        return all;
    }

    void write(rt_u32 number, const LightBound& bound, double all) {
        rt_light_node& node = nodes_[number];
        for (size_t k = 0; k < 3; ++k) {
            node.lower[k] = static_cast<float>(bound.lower[k]);
            node.upper[k] = static_cast<float>(bound.upper[k]);
            node.axis[k] = static_cast<float>(bound.axis[k]);
        }
        node.intensity = static_cast<float>(bound.intensity / all);
        node.cos_spread = static_cast<float>(std::cos(std::min(bound.spread + kSlack, kPi)));
        node.cos_reach = static_cast<float>(std::cos(std::min(bound.reach + kSlack, kPi / 2)));
        node.two_sided = bound.two_sided;
        node.child = RT_NONE;
    }

    // Brings the emitters of the first child to the front and returns where those of the second begin.
    size_t divide(size_t begin, size_t end, const LightBound& parent) {
        Vec low{kInfinity, kInfinity, kInfinity}, high = -1.0 * low;
        for (size_t i = begin; i < end; ++i)
            for (int k = 0; k < 3; ++k) {
                low[size_t(k)] = std::min(low[size_t(k)], middle(at(i), k));
                high[size_t(k)] = std::max(high[size_t(k)], middle(at(i), k));
            }
        const Vec size = parent.upper - parent.lower;
        const double longest = std::max({size[0], size[1], size[2]});
        Split best;
        for (int k = 0; k < 3; ++k) {
            const double width = high[size_t(k)] - low[size_t(k)];
            if (!(width > 0)) continue;
            // Thin boxes are no good bounds: the paper's regularization.
            Split split = best_split(begin, end, k, {low[size_t(k)], kBins / width});
            split.cost *= longest / size[size_t(k)];
            if (split.cost < best.cost) best = split;
        }
        const auto first = order_.begin() + std::ptrdiff_t(begin), last = order_.begin() + std::ptrdiff_t(end);
        if (best.cost < kInfinity) {
            const size_t k = size_t(best.axis);
            const Bins bin{low[k], kBins / (high[k] - low[k])};
            const auto half =
                std::partition(first, last, [&](size_t i) { return bin(middle(bounds_[i], best.axis)) <= best.bin; });
            if (half != first && half != last) return size_t(half - order_.begin());
        }
        return begin + (end - begin) / 2;  // all are in one place
    }

    Split best_split(size_t begin, size_t end, int axis, const Bins& bin) const {
        LightBound bins[kBins];
        bool used[kBins] = {};
        for (size_t i = begin; i < end; ++i) {
            const int b = bin(middle(at(i), axis));
            bins[b] = used[b] ? join(bins[b], at(i)) : at(i);
            used[b] = true;
        }
        // Costs of the bins from each one on.
        double behind[kBins + 1] = {};
        LightBound sum;
        bool any = false;
        for (int b = kBins; b-- > 0;) {
            if (used[b]) sum = any ? join(sum, bins[b]) : bins[b];
            any = any || used[b];
            behind[b] = any ? cost(sum) : kInfinity;
        }
        Split best;
        best.axis = axis;
        any = false;
        for (int b = 0; b + 1 < kBins; ++b) {
            if (used[b]) sum = any ? join(sum, bins[b]) : bins[b];
            any = any || used[b];
            const double both = any ? cost(sum) + behind[b + 1] : kInfinity;
            if (both < best.cost) best.cost = both, best.bin = b;
        }
        return best;
    }

    const std::vector<LightBound>& bounds_;
    std::vector<rt_u32>& leaves_;
    std::vector<size_t> order_;
    std::vector<rt_light_node> nodes_;
};

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

std::vector<rt_light_node> build_light_tree(const std::vector<LightBound>& bounds, std::vector<rt_u32>& leaves) {
    return Builder(bounds, leaves).build();
}

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
