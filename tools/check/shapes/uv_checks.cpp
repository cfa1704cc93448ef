#include "tools/check/shapes/surface_checks.hpp"

#include <algorithm>
#include <cmath>

#include "base/angle.hpp"
#include "base/numbers.hpp"
#include "stand/seed.hpp"

namespace clarity::check {
namespace {

constexpr double kGradientStep = 1e-3;  // all lengths are shares of the part's size
constexpr double kPathStep = 1.0 / 64;
constexpr double kLoopRadius = 1.0 / 50;
constexpr int kPathSteps = 16, kHalvings = 10, kLoopPoints = 24, kDescents = 40;
constexpr size_t kLeastFlat = 20;  // a picture may be without area at one of so many points: that much is left to rounding
constexpr size_t kMostPaths = 160, kMostSeams = 8, kMostPoles = 12;  // of a part
constexpr double kJump = 0.03, kJumpLeft = 0.01;  // between two samples; between two that are next to each other
constexpr double kSameSheet = 0.9;                // cosine between normals of neighbours
constexpr double kSmooth = 0.999;                 // the same of those that are next to each other
constexpr char kNames[] = "uv";

// A point of the surface.
struct Spot {
    Vec at{}, normal{};  // unit, on the side from which it was found
    double uv[2] = {0, 0};
    bool found = false, is_back = false;  // is_back: the surface's own normal points to the other side
};

// The difference of two texture coordinates: 0.99 and 0.01 are neighbours, because pictures repeat.
double wrapped(double difference) {
    return difference - std::round(difference);
}

// Finds points of one part's surface.
class Surface {
 public:
    Surface(ShapeProbe& probe, const ShapeSubject& subject) : probe_(probe), subject_(subject) {}
    double size() const { return double(subject_.size); }

    // The points below `from`, each moved by `by`. lift: how far above the surface the rays begin.
    std::vector<Spot> find(const std::vector<Spot>& from, const std::vector<Vec>& by, double lift) {
        lift = std::max(lift, 10 * slack_of(subject_));
        std::vector<rt_ray> rays;
        for (size_t i = 0; i < from.size(); ++i)
            rays.push_back(ray_of(from[i].at + by[i] + lift * from[i].normal, -1.0 * from[i].normal));
        const std::vector<ProbeHit> hits = probe_.hits(subject_, rays);
        std::vector<ProbePoint> points;
        std::vector<Spot> spots(from.size());
        for (size_t i = 0; i < rays.size(); ++i) {
            spots[i].found = from[i].found && is_hit(rays[i], hits[i]) && std::fabs(double(hits[i].t) - lift) < 0.8 * lift;
            spots[i].at = point_of(rays[i], spots[i].found ? double(hits[i].t) : lift);
            points.push_back({{float(spots[i].at[0]), float(spots[i].at[1]), float(spots[i].at[2])}, hits[i].u, hits[i].v});
        }
        const std::vector<ProbeSurface> surfaces = probe_.surfaces(subject_, points);
        for (size_t i = 0; i < spots.size(); ++i) {
            const Vec n = to_vec(surfaces[i].normal);
            spots[i].found = spots[i].found && dot(n, n) > 0 && std::isfinite(dot(n, n));
            if (!spots[i].found) continue;
            spots[i].is_back = from[i].is_back;
            spots[i].normal = (from[i].is_back ? -1 : 1) * normalized(n);
            // Else it is around an edge, or on the other side of something thin.
            spots[i].found = dot(spots[i].normal, from[i].normal) > kSameSheet;
            spots[i].uv[0] = double(surfaces[i].tex_u);
            spots[i].uv[1] = double(surfaces[i].tex_v);
        }
        return spots;
    }

    // How u and v grow along two directions across the normal. found: of the surface.
    struct Slope {
        Vec x{}, y{};
        double of[2][2] = {};  // [coordinate][direction]
        bool found = false;
    };
    std::vector<Slope> slopes(const std::vector<Spot>& at) {
        std::vector<Spot> from;
        std::vector<Vec> by;
        std::vector<Slope> slopes(at.size());
        const double step = kGradientStep * size();
        for (size_t i = 0; i < at.size(); ++i) {
            Slope& slope = slopes[i];
            slope.x = across(at[i].found ? at[i].normal : Vec{0, 0, 1});
            slope.y = cross(at[i].found ? at[i].normal : Vec{0, 0, 1}, slope.x);
            for (const Vec& way : {slope.x, -1.0 * slope.x, slope.y, -1.0 * slope.y}) {
                from.push_back(at[i]);
                by.push_back(step * way);
            }
        }
        const std::vector<Spot> beside = find(from, by, step);
        for (size_t i = 0; i < at.size(); ++i) {
            const Spot* const b = &beside[4 * i];
            slopes[i].found = b[0].found && b[1].found && b[2].found && b[3].found;
            for (int c = 0; c < 2; ++c)
                for (int k = 0; k < 2; ++k) slopes[i].of[c][k] = wrapped(b[2 * k].uv[c] - b[2 * k + 1].uv[c]) / (2 * step);
        }
        return slopes;
    }

 private:
    ShapeProbe& probe_;
    const ShapeSubject& subject_;
};

std::string at_text(const Spot& spot) {
    const auto text = [](double x) { return exact_text(static_cast<float>(x)); };
    return "at " + text(spot.at[0]) + " " + text(spot.at[1]) + " " + text(spot.at[2]) + ", where u is " + text(spot.uv[0]) +
           " and v " + text(spot.uv[1]);
}

// Where a picture comes to a point, the other coordinate is at an end.
bool is_end(double coordinate) {
    return coordinate < 0.02 || coordinate > 0.98;
}

// The smooth touches of a part as spots.
std::vector<Spot> smooth_spots(const TouchedPart& part) {
    std::vector<Spot> spots;
    for (size_t i = 0; i < part.touches.size(); ++i) {
        const Touch& touch = part.touches[i];
        if (!touch.is_smooth || touch.cosine < 0.3) continue;
        Spot spot;
        spot.at = touch.at;
        spot.normal = touch.across;
        spot.is_back = dot(to_vec(part.surfaces[i].normal), touch.across) < 0;
        spot.uv[0] = double(part.surfaces[i].tex_u);
        spot.uv[1] = double(part.surfaces[i].tex_v);
        spot.found = true;
        spots.push_back(spot);
    }
    return spots;
}

// A picture that is pressed into a line or a point. Returns what is wrong; empty: nothing.
std::string fault_of_area(Surface& surface, const std::vector<Spot>& spots) {
    size_t flat = 0, all = 0;
    const Spot* first = nullptr;
    const std::vector<Surface::Slope> slopes = surface.slopes(spots);
    for (size_t i = 0; i < spots.size(); ++i) {
        if (!slopes[i].found) continue;
        ++all;
        const auto& s = slopes[i].of;
        const double u = std::hypot(s[0][0], s[0][1]), v = std::hypot(s[1][0], s[1][1]);
        const double least = 1e-3 / surface.size();
        if (u > least && v > least && std::fabs(s[0][0] * s[1][1] - s[0][1] * s[1][0]) > 1e-3 * u * v) continue;
        if (flat++ == 0) first = &spots[i];
    }
    if (all < 20 || flat < 3 || flat * kLeastFlat < all) return {};
    return "at " + std::to_string(flat) + " of " + std::to_string(all) +
           " points u and v do not change in two directions, so that a picture has no area there, as " + at_text(*first);
}

// Two points next to each other.
struct Pair {
    Spot a, b;
    double jump(int c) const { return std::fabs(wrapped(a.uv[c] - b.uv[c])); }
};

// Pairs of neighbours on ways over the surface in which u or v differs much, moved so close to each other that only a jump
// remains.
std::vector<Pair> steep_pairs(Surface& surface, const std::vector<Spot>& spots, std::mt19937& random) {
    std::vector<Spot> at(spots.begin(), spots.begin() + static_cast<std::ptrdiff_t>(std::min(spots.size(), kMostPaths)));
    std::vector<Vec> ways;
    for (const Spot& spot : at) ways.push_back(normalized(cross(spot.normal, random_direction(random))));
    const double step = kPathStep * surface.size();
    std::vector<Pair> pairs;
    for (int k = 0; k < kPathSteps; ++k) {
        std::vector<Vec> by;
        for (size_t i = 0; i < at.size(); ++i) {
            const Vec along = ways[i] - dot(ways[i], at[i].normal) * at[i].normal;
            ways[i] = length(along) > 1e-6 ? normalized(along) : across(at[i].normal);
            by.push_back(step * ways[i]);
        }
        const std::vector<Spot> next = surface.find(at, by, step);
        for (size_t i = 0; i < at.size(); ++i)
            for (int c = 0; c < 2; ++c)
                if (next[i].found && std::fabs(next[i].uv[c] - at[i].uv[c]) > kJump) {
                    pairs.push_back({at[i], next[i]});
                    break;
                }
        at = next;
    }
    for (int k = 0; k < kHalvings && !pairs.empty(); ++k) {
        std::vector<Spot> middles;
        double apart = 0;
        for (const Pair& pair : pairs) {
            Spot middle = pair.a;
            middle.at = 0.5 * (pair.a.at + pair.b.at);
            middle.normal = normalized(pair.a.normal + pair.b.normal);
            apart = std::max(apart, length(pair.a.at - pair.b.at));
            middles.push_back(middle);
        }
        const std::vector<Spot> found = surface.find(middles, std::vector<Vec>(middles.size(), Vec{}), apart);
        std::vector<Pair> closer;
        for (size_t i = 0; i < pairs.size(); ++i) {
            if (!found[i].found) continue;
            const auto steepness = [](const Spot& a, const Spot& b) {
                return std::max(std::fabs(a.uv[0] - b.uv[0]), std::fabs(a.uv[1] - b.uv[1]));
            };
            const bool first = steepness(pairs[i].a, found[i]) > steepness(found[i], pairs[i].b);
            closer.push_back(first ? Pair{pairs[i].a, found[i]} : Pair{found[i], pairs[i].b});
        }
        pairs = std::move(closer);
    }
    // So close to each other, normals differ at an edge alone, however blunt it is. There coordinates may jump.
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                               [](const Pair& pair) { return dot(pair.a.normal, pair.b.normal) < kSmooth; }),
                pairs.end());
    return pairs;
}

// Follows the line on which one coordinate does not change, from a seam of the other one, c, at which it is near 0 (way 1), or
// near 1 (way -1).
enum class End { closed, elsewhere, lost };
std::vector<End> follow(Surface& surface, const std::vector<Spot>& starts, int c, double way) {
    constexpr double kGrowth = 0.02;  // of the coordinate, each step
    constexpr int kMost = 400;
    constexpr double kLeastStep = 1.0 / 128;  // of a step: below it, what is not found is lost
    std::vector<End> ends(starts.size(), End::lost);
    std::vector<double> lengths(starts.size(), 0), passed(starts.size(), 0);
    std::vector<double> step(starts.size(), 1);  // shorter where the surface is sharply bent
    std::vector<Spot> at = starts;
    for (int k = 0; k < kMost && std::any_of(at.begin(), at.end(), [](const Spot& s) { return s.found; }); ++k) {
        const std::vector<Surface::Slope> slopes = surface.slopes(at);
        std::vector<Vec> by(at.size());
        for (size_t i = 0; i < at.size(); ++i) {
            const auto& s = slopes[i].of;
            const double determinant = s[c][0] * s[1 - c][1] - s[c][1] * s[1 - c][0];
            at[i].found = at[i].found && slopes[i].found && determinant != 0;
            if (!at[i].found) continue;
            const double grow = way * kGrowth * step[i], correct = wrapped(starts[i].uv[1 - c] - at[i].uv[1 - c]);
            const double x = (grow * s[1 - c][1] - correct * s[c][1]) / determinant;
            const double y = (correct * s[c][0] - grow * s[1 - c][0]) / determinant;
            by[i] = x * slopes[i].x + y * slopes[i].y;
            const double most = step[i] * surface.size() / 12;
            if (length(by[i]) > most) by[i] = (most / length(by[i])) * by[i];
        }
        const std::vector<Spot> next = surface.find(at, by, surface.size() / 24);
        for (size_t i = 0; i < at.size(); ++i) {
            if (!at[i].found) continue;
            if (!next[i].found) {
                step[i] /= 2;
                at[i].found = step[i] >= kLeastStep;
                continue;
            }
            step[i] = std::min(1.0, 2 * step[i]);
            lengths[i] += length(next[i].at - at[i].at);
            passed[i] += way * wrapped(next[i].uv[c] - at[i].uv[c]);
            at[i] = next[i];
            if (passed[i] < 0.96) continue;
            ends[i] = length(at[i].at - starts[i].at) < 0.25 * lengths[i] ? End::closed : End::elsewhere;
            at[i].found = false;
        }
    }
    return ends;
}

// Seams: u or v goes from 1 to 0. On a surface that is closed in this direction there is one; it is met again at the end of
// the way around. Returns what is wrong; empty: nothing.
std::string fault_of_seams(Surface& surface, const std::vector<Pair>& pairs) {
    for (int c = 0; c < 2; ++c) {
        std::vector<Spot> low, high;
        for (const Pair& pair : pairs) {
            if (pair.jump(c) > kJumpLeft || std::fabs(pair.a.uv[c] - pair.b.uv[c]) < 0.5 || low.size() >= kMostSeams) continue;
            const bool first_low = pair.a.uv[c] < pair.b.uv[c];
            low.push_back(first_low ? pair.a : pair.b);
            high.push_back(first_low ? pair.b : pair.a);
        }
        if (low.empty()) continue;
        const std::vector<End> up = follow(surface, low, c, 1), down = follow(surface, high, c, -1);
        size_t closed = 0, open = 0;
        for (size_t i = 0; i < low.size(); ++i) {
            if (up[i] == End::elsewhere)
                return std::string(1, kNames[c]) + " goes from 1 to 0 " + at_text(low[i]) +
                       ", and is 1 again elsewhere: it begins anew within the surface, where nothing of the surface shows why";
            closed += up[i] == End::closed || down[i] == End::closed;
            open += up[i] == End::lost && down[i] == End::lost;
        }
        if (open >= 3 && closed == 0)
            return std::string(1, kNames[c]) + " goes from 1 to 0 " + at_text(low.front()) +
                   ", but the surface is not closed in this direction: it should begin at an edge";
    }
    return {};
}

// Points at which one coordinate comes to its end, with other values all around: the other coordinate must turn once about
// them. Returns what is wrong; empty: nothing.
std::string fault_of_poles(Surface& surface, const std::vector<Spot>& spots, size_t& poles) {
    for (int c = 0; c < 2; ++c)
        for (const double end : {0.0, 1.0}) {
            std::vector<Spot> at;
            for (const Spot& spot : spots)
                if (std::fabs(spot.uv[c] - end) < 0.2 && at.size() < kMostPoles) at.push_back(spot);
            if (at.empty()) continue;
            for (int k = 0; k < kDescents; ++k) {
                const std::vector<Surface::Slope> slopes = surface.slopes(at);
                std::vector<Vec> by(at.size());
                for (size_t i = 0; i < at.size(); ++i) {
                    const double room = end - at[i].uv[c];
                    const auto& s = slopes[i].of[c];
                    const double steep = s[0] * s[0] + s[1] * s[1];
                    if (!at[i].found || !slopes[i].found || std::fabs(room) < 1e-4 || steep == 0) continue;
                    by[i] = (room / steep) * (s[0] * slopes[i].x + s[1] * slopes[i].y);
                    const double most = surface.size() / 20;
                    if (length(by[i]) > most) by[i] = (most / length(by[i])) * by[i];
                }
                const std::vector<Spot> next = surface.find(at, by, surface.size() / 40);
                for (size_t i = 0; i < at.size(); ++i)
                    if (length(by[i]) > 0) at[i] = next[i];
            }
            std::vector<Spot> from;
            std::vector<Vec> by;
            for (const Spot& spot : at)
                for (int k = 0; k < kLoopPoints; ++k) {
                    const Vec x = across(spot.found ? spot.normal : Vec{0, 0, 1}),
                              y = cross(spot.found ? spot.normal : Vec{0, 0, 1}, x);
                    const double angle = kTurn * k / kLoopPoints, r = kLoopRadius * surface.size();
                    from.push_back(spot);
                    by.push_back(r * std::cos(angle) * x + r * std::sin(angle) * y);
                }
            const std::vector<Spot> around = surface.find(from, by, kLoopRadius * surface.size());
            for (size_t i = 0; i < at.size(); ++i) {
                if (!at[i].found || std::fabs(at[i].uv[c] - end) > 1e-3) continue;
                const Spot* const loop = &around[i * kLoopPoints];
                // Everywhere around, the coordinate is on the one side of its end.
                bool is_pole = true;
                double turns = 0;
                for (int k = 0; k < kLoopPoints; ++k) {
                    const double away = (end > 0 ? -1 : 1) * (loop[k].uv[c] - end);
                    is_pole = is_pole && loop[k].found && away > std::fabs(at[i].uv[c] - end) + 1e-5 && away < 0.5;
                    turns += wrapped(loop[(k + 1) % kLoopPoints].uv[1 - c] - loop[k].uv[1 - c]);
                }
                if (!is_pole) continue;
                ++poles;
                const long times = std::lround(std::fabs(turns));
                if (times == 1) continue;
                return std::string(1, kNames[c]) + " comes to its end " + at_text(at[i]) + ", but around this point " +
                       kNames[1 - c] + (times == 0 ? " does not turn" : " turns " + std::to_string(times) + " times") +
                       ": there it should go once from 0 to 1, so it turns about another point or repeats";
            }
        }
    return {};
}

}  // namespace

Outcome surface_uv(ShapeStand& stand, const Step& step) {
    RayFindings findings;
    constexpr float kRoom = 1e-3f;
    for (const TouchedPart& part : stand.parts(step))
        for (size_t i = 0; i < part.touches.size(); ++i) {
            const ProbeSurface& s = part.surfaces[i];
            findings.tried();
            if (s.tex_u >= -kRoom && s.tex_u <= 1 + kRoom && s.tex_v >= -kRoom && s.tex_v <= 1 + kRoom) continue;
            findings.wrong(part.subject, part.touches[i].ray, false,
                           "texture coordinates " + exact_text(s.tex_u) + ", " + exact_text(s.tex_v));
        }
    if (!findings.empty()) return Outcome::failed(findings.text("texture coordinates are not within 0 and 1"));
    size_t jumps = 0, poles = 0;
    std::mt19937 random = random_of(61, stand.options().seed);
    for (const TouchedPart& part : stand.parts(step)) {
        Surface surface(stand.first_probe(step), part.subject);
        const std::vector<Spot> spots = smooth_spots(part);
        if (spots.empty()) continue;
        const auto failed = [&](const std::string& why) { return Outcome::failed(why + ". The shape: " + part.subject.what); };
        step("following texture coordinates over " + part.subject.what, 2 * kShapeTrace_s);
        if (const std::string why = fault_of_area(surface, spots); !why.empty()) return failed(why);
        const std::vector<Pair> pairs = steep_pairs(surface, spots, random);
        for (const Pair& pair : pairs)
            for (int c = 0; c < 2; ++c) {
                if (pair.jump(c) < kJumpLeft || is_end(pair.a.uv[1 - c])) continue;
                return failed(std::string(1, kNames[c]) + " jumps by " + exact_text(static_cast<float>(pair.jump(c))) + " " +
                              at_text(pair.a) + ", while the surface is smooth");
            }
        jumps += pairs.size();
        step("looking for where texture coordinates of " + part.subject.what + " begin", 2 * kShapeTrace_s);
        if (const std::string why = fault_of_seams(surface, pairs); !why.empty()) return failed(why);
        if (const std::string why = fault_of_poles(surface, spots, poles); !why.empty()) return failed(why);
    }
    return Outcome::passed(std::to_string(findings.tried_count()) + " pairs are within 0 and 1 and continuous; " +
                           std::to_string(jumps) + " steep places and " + std::to_string(poles) +
                           " turns about a point are in order");
}

}  // namespace clarity::check
