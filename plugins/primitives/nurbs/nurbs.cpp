// nurbs: a rational spline surface, handed over as rational Bezier patches.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "rt_plugin.hpp"

namespace {

constexpr int kMaxDegree = 5;  // nurbs.cl has room for as much

using Homogeneous = std::array<double, 4>;  // x w, y w, z w, w

// One direction of the surface.
struct Direction {
    int degree = 3, points = 0;
    std::vector<double> knots;  // points + degree + 1, ascending

    // Fills in knots if there are none: those of a spline that begins and ends at its outer points. Returns what is wrong with
    // them, or nothing. name: "u".
    std::string complete(char name);
};

struct Surface {
    Direction u, v;
    std::vector<Homogeneous> points;  // u.points in a row, v.points rows
};

// A part of the surface as one patch. Its range is a share of the surface's, 0 to 1.
struct Patch {
    std::vector<Homogeneous> points;  // (v.degree + 1) of each of (u.degree + 1) columns
    std::array<double, 2> u, v;
};

// Polar forms (Ramshaw 1989, "Blossoms are Polar Forms"): the Bezier points of a spline of degree p between two parameters a
// and b are the values of its polar form at p - k times a and k times b. De Boor's algorithm computes it, with another
// parameter in each of its steps.

constexpr double kBend = 0.5;    // radians that the control polygon of a patch may turn
constexpr int kMostPieces = 16;  // between two knots

Homogeneous mix(const Homogeneous& a, const Homogeneous& b, double share) {
    Homogeneous m;
    for (size_t k = 0; k < 4; ++k) m[k] = (1 - share) * a[k] + share * b[k];
    return m;
}

// The Bezier points of the piece from a to b, which lies between the knots `span` and `span` + 1.
std::vector<Homogeneous> bezier(const Direction& along, const std::vector<Homogeneous>& points, int span, double a, double b) {
    const int p = along.degree;
    std::vector<Homogeneous> result;
    for (int k = 0; k <= p; ++k) {
        std::vector<Homogeneous> d(points.begin() + (span - p), points.begin() + span + 1);
        for (int r = 1; r <= p; ++r) {
            const double t = r <= p - k ? a : b;
            for (int i = span; i >= span - p + r; --i) {
                const double low = along.knots[size_t(i)], high = along.knots[size_t(i + p - r + 1)];
                const size_t at = size_t(i - (span - p));
                d[at] = mix(d[at - 1], d[at], (t - low) / (high - low));
            }
        }
        result.push_back(d.back());
    }
    return result;
}

struct Piece {
    int span;
    double from, to;
};

// How far a polygon of points turns, in radians.
double turning(const std::vector<Homogeneous>& points) {
    double sum = 0;
    std::array<double, 3> last{};
    for (size_t i = 1; i < points.size(); ++i) {
        std::array<double, 3> leg;
        double length2 = 0, cosine = 0;
        for (size_t k = 0; k < 3; ++k) {
            leg[k] = points[i][k] / points[i][3] - points[i - 1][k] / points[i - 1][3];
            length2 += leg[k] * leg[k];
        }
        if (!(length2 > 0)) continue;
        for (size_t k = 0; k < 3; ++k) {
            leg[k] /= std::sqrt(length2);
            cosine += leg[k] * last[k];
        }
        if (last != std::array<double, 3>{}) sum += std::acos(std::clamp(cosine, -1.0, 1.0));
        last = leg;
    }
    return sum;
}

// Cuts a direction at its knots, and each piece into as many as the most bent of `curves` asks for.
std::vector<Piece> pieces(const Direction& along, const std::vector<std::vector<Homogeneous>>& curves) {
    std::vector<Piece> all;
    for (int span = along.degree; span < along.points; ++span) {
        const double from = along.knots[size_t(span)], to = along.knots[size_t(span) + 1];
        if (!(to > from)) continue;
        double bend = 0;
        for (const auto& curve : curves) bend = std::max(bend, turning(bezier(along, curve, span, from, to)));
        const int count = std::clamp(static_cast<int>(std::ceil(bend / kBend)), 1, kMostPieces);
        for (int i = 0; i < count; ++i)
            all.push_back({span, from + (to - from) * i / count, i + 1 == count ? to : from + (to - from) * (i + 1) / count});
    }
    return all;
}

std::array<double, 2> share(const Direction& along, const Piece& piece) {
    const double first = along.knots[size_t(along.degree)], last = along.knots[size_t(along.points)];
    return {(piece.from - first) / (last - first), (piece.to - first) / (last - first)};
}

std::string Direction::complete(char name) {
    const std::string which = std::string("`knots_") + name + "`";
    if (points <= degree)
        return std::to_string(points) + " points in direction " + name + "; expected more than its degree, " +
               std::to_string(degree);
    const size_t count = size_t(points) + size_t(degree) + 1;
    if (knots.empty())
        for (size_t i = 0; i < count; ++i) knots.push_back(std::clamp(int(i) - degree, 0, points - degree));
    if (knots.size() != count)
        return std::to_string(knots.size()) + " numbers for " + which +
               "; expected points + degree + 1 = " + std::to_string(count);
    if (!std::is_sorted(knots.begin(), knots.end()))
        return which + " do not ascend; expected each knot at least as large as the one before";
    if (!(knots[size_t(points)] > knots[size_t(degree)]))
        return which + " span nothing; expected a range between the outer knots";
    for (size_t i = 1; i + size_t(degree) + 1 < count; ++i)
        if (i > size_t(degree) && i < size_t(points) && knots[i] == knots[i + size_t(degree)])
            return which + " has one number more than `degree` times inside of its range, which tears the surface";
    return {};
}

// Cuts the surface at its knots, and into smaller patches where it bends, so that few rays need many steps in one.
std::vector<Patch> patches(const Surface& surface) {
    const Direction &u = surface.u, &v = surface.v;
    std::vector<std::vector<Homogeneous>> rows(static_cast<size_t>(v.points)), columns(static_cast<size_t>(u.points));
    for (size_t j = 0; j < rows.size(); ++j)
        for (size_t i = 0; i < columns.size(); ++i) {
            rows[j].push_back(surface.points[j * columns.size() + i]);
            columns[i].push_back(surface.points[j * columns.size() + i]);
        }
    const std::vector<Piece> pieces_u = pieces(u, rows), pieces_v = pieces(v, columns);
    std::vector<Patch> all;
    for (const Piece& a : pieces_u) {
        std::vector<std::vector<Homogeneous>> strip(static_cast<size_t>(u.degree) + 1);  // columns of the piece along u
        for (const auto& row : rows) {
            const std::vector<Homogeneous> cut = bezier(u, row, a.span, a.from, a.to);
            for (size_t i = 0; i < cut.size(); ++i) strip[i].push_back(cut[i]);
        }
        for (const Piece& b : pieces_v) {
            Patch patch{{}, share(u, a), share(v, b)};
            for (const auto& column : strip) {
                const std::vector<Homogeneous> cut = bezier(v, column, b.span, b.from, b.to);
                patch.points.insert(patch.points.end(), cut.begin(), cut.end());
            }
            all.push_back(std::move(patch));
        }
    }
    return all;
}

enum { kDegreeU, kDegreeV, kColumns, kPoints, kWeights, kKnotsU, kKnotsV };

std::vector<double> numbers_of(const rt_key_values& values) {
    return {values.numbers, values.numbers + values.count};
}

Surface read(const rt_host* host, const rt_key_values* values) {
    Surface surface;
    const size_t points = values[kPoints].count / 3, columns = static_cast<size_t>(values[kColumns].numbers[0]);
    if (points % columns != 0)
        throw rt::fail(host, std::to_string(points) + " `points` are no full rows of `columns` " + std::to_string(columns));
    const std::vector<double> weights = numbers_of(values[kWeights]);
    if (!weights.empty() && weights.size() != points)
        throw rt::fail(host, std::to_string(weights.size()) + " `weights`; expected one for each of " + std::to_string(points) +
                                 " points");
    for (size_t i = 0; i < points; ++i) {
        const double w = weights.empty() ? 1 : weights[i];
        if (!(w > 0)) throw rt::fail(host, "weight " + std::to_string(i + 1) + " is not above 0");
        const float* p = values[kPoints].numbers + 3 * i;
        surface.points.push_back({p[0] * w, p[1] * w, p[2] * w, w});
    }
    surface.u = {static_cast<int>(values[kDegreeU].numbers[0]), static_cast<int>(columns), numbers_of(values[kKnotsU])};
    surface.v = {static_cast<int>(values[kDegreeV].numbers[0]), static_cast<int>(points / columns),
                 numbers_of(values[kKnotsV])};
    for (const std::string& why : {surface.u.complete('u'), surface.v.complete('v')})
        if (!why.empty()) throw rt::fail(host, why);
    return surface;
}

// numbers: degrees, ranges of the parameters, a point in the middle. more: the patch's points, relative to that.
void hand_over(const Surface& surface, const Patch& patch, const rt_shape_output* out) {
    float lo[3], hi[3];
    for (size_t k = 0; k < 3; ++k) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
        for (const Homogeneous& p : patch.points) {  // the surface lies within the hull of its points
            lo[k] = std::min(lo[k], static_cast<float>(p[k] / p[3]));
            hi[k] = std::max(hi[k], static_cast<float>(p[k] / p[3]));
        }
    }
    float numbers[9] = {static_cast<float>(surface.u.degree), static_cast<float>(surface.v.degree)};
    for (size_t k = 0; k < 2; ++k) {
        numbers[2 + k] = static_cast<float>(patch.u[k]);
        numbers[4 + k] = static_cast<float>(patch.v[k]);
    }
    for (size_t k = 0; k < 3; ++k) numbers[6 + k] = 0.5f * (lo[k] + hi[k]);
    std::vector<float> more;
    double most = 0;  // only ratios of weights matter
    for (const Homogeneous& p : patch.points) most = std::max(most, p[3]);
    for (const Homogeneous& p : patch.points) {
        for (size_t k = 0; k < 3; ++k) more.push_back(static_cast<float>((p[k] - p[3] * numbers[6 + k]) / most));
        more.push_back(static_cast<float>(p[3] / most));
    }
    rt::part(out, lo, hi, numbers, 9, more.data(), more.size());
}

int32_t prepare(const rt_host* host, const rt_key_values* values, const rt_shape_output* out) {
    const Surface surface = read(host, values);
    for (const Patch& patch : patches(surface)) hand_over(surface, patch, out);
    return RT_OK;
}

constexpr rt_key keys[] = {
    rt::whole_key("degree_u", "of its curves along u", 1, kMaxDegree, 3),
    rt::whole_key("degree_v", "of its curves along v", 1, kMaxDegree, 3),
    rt::whole_key("columns", "points along u", 2, 1 << 20, 4),
    rt::key(RT_KEY_POINTS, "points", "x y z of all points, row after row along u"),
    rt::list_key(RT_KEY_NUMBERS, "weights", "of all points, above 0; without them all are 1"),
    rt::list_key(RT_KEY_NUMBERS, "knots_u", "ascending; without them the surface ends at its outer points"),
    rt::list_key(RT_KEY_NUMBERS, "knots_v", "ascending; without them the surface ends at its outer points"),
};
constexpr rt_cl_file files[] = {
#include "nurbs.inc"
};
constexpr rt_primitive primitive =
    rt::primitive(keys, rt::file(files, "nurbs.cl"), nullptr, rt::guarded<prepare>, RT_SHAPE_SINGLE_RAY);

}  // namespace

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::primitive_plugin("nurbs", "NURBS surface", "1.0.0",
                         "Nishita, Sederberg, Kakimoto 1990, Ray Tracing Trimmed Rational Surface Patches", primitive);
