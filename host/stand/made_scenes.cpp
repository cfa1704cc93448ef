#include "stand/made_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/angle.hpp"
#include "base/lowbias32.hpp"
#include "stand/seed.hpp"

namespace clarity {

SceneMaker::SceneMaker(uint64_t seed, Scene into) : scene(std::move(into)), random_(random_of(17, seed)) {
    if (scene.materials.empty()) scene.materials.push_back({"default", default_material()});
}

float SceneMaker::random() {
    return std::uniform_real_distribution<float>(0, 1)(random_);
}

Point SceneMaker::around(const Point& center, float spread) {
    Point p = center;
    for (float& c : p) c += spread * (2 * random() - 1);
    return p;
}

void SceneMaker::add_soup(const Point& center, float spread, float size, uint64_t count) {
    for (uint64_t i = 0; i < count; ++i) {
        const Point p = around(center, spread);
        const float s = size * (0.1f + random() * random());
        add_triangle(p, around(p, s), around(p, s));
    }
}

void SceneMaker::add_polygon(const std::vector<Point>& corners) {
    scene.polygons.push_back({static_cast<rt_u32>(scene.polygon_corners.size() / 3), static_cast<rt_u32>(corners.size()), 0});
    for (const Point& p : corners) scene.polygon_corners.insert(scene.polygon_corners.end(), p.begin(), p.end());
}

rt_u32 SceneMaker::end_mesh() {
    return add_mesh(scene, std::exchange(static_cast<TriangleMesh&>(*this), {}));
}

Affine placed(const Point& at, float angle, const Point& scale) {
    const float c = std::cos(angle), s = std::sin(angle), x = 0.48f, y = 0.6f, z = 0.64f, k = 1 - c;
    const float turn[9] = {c + k * x * x,     k * x * y - s * z, k * x * z + s * y, k * x * y + s * z, c + k * y * y,
                           k * y * z - s * x, k * x * z - s * y, k * y * z + s * x, c + k * z * z};
    Affine m{};
    for (int r = 0; r < 3; ++r) {
        for (int j = 0; j < 3; ++j) m[4 * r + j] = turn[3 * r + j] * scale[j];
        m[4 * r + 3] = at[r];
    }
    return m;
}

namespace {

// Numbers from 0 to 1 by a counter.
class Chance {
 public:
    double operator()() { return lowbias32(++count_) / 4294967296.0; }
    double between(double a, double b) { return a + (b - a) * (*this)(); }
    Vec direction() {
        const double z = between(-1, 1), angle = between(0, kTurn), r = std::sqrt(std::max(0.0, 1 - z * z));
        return {r * std::cos(angle), r * std::sin(angle), z};
    }

 private:
    uint32_t count_ = 0;
};

// Sums of sines in several directions, each octave half as high and twice as fine.
double height_at(double x, double z) {
    double sum = 0;
    for (int octave = 0; octave < 7; ++octave) {
        const double turn = 1.1 * octave, f = 1.3 * (1 << octave);
        const double u = std::cos(turn) * x - std::sin(turn) * z, v = std::sin(turn) * x + std::cos(turn) * z;
        sum += std::sin(f * u + octave) * std::sin(f * v - 2 * octave) / (1 << octave);
    }
    return 0.35 * sum;
}

}  // namespace

namespace made {

void stadium(SceneMaker& make, uint64_t triangles) {
    const Bounds box = make.scene.bounds();
    Vec middle{};
    double size = 1;
    if (!box.empty) {
        size = 0;
        for (int k = 0; k < 3; ++k) {
            middle[k] = 0.5 * (double(box.min[k]) + box.max[k]);
            size = std::max(size, double(box.max[k]) - box.min[k]);
        }
        middle[1] = box.min[1];
    }
    const auto at = [&](double radius, double angle, double height) {
        return middle + size * Vec{1.3 * radius * std::cos(angle), height, radius * std::sin(angle)};
    };
    const unsigned tiers = 24;
    const auto parts = static_cast<unsigned>(std::clamp<uint64_t>(triangles / (4 * tiers), 12, 4096));
    // The pitch is two triangles, and its corners are under the stands. A fan of slivers around the middle would put hundreds
    // of boxes over one another exactly where the camera looks.
    const auto corner = [&](double x, double z) { return middle + size * Vec{52 * x, 0, 40 * z}; };
    make.add_quad(corner(-1, -1), corner(-1, 1), corner(1, 1), corner(1, -1));
    for (unsigned i = 0; i < parts; ++i) {
        const double a = kTurn * i / parts, b = kTurn * (i + 1) / parts;
        for (unsigned t = 0; t < tiers; ++t) {  // a step's front and its seat
            const double r = 40 + 2.5 * t, h = 1.2 * t;
            make.add_quad(at(r, a, h), at(r, b, h), at(r, b, h + 1.2), at(r, a, h + 1.2));
            make.add_quad(at(r, a, h + 1.2), at(r, b, h + 1.2), at(r + 2.5, b, h + 1.2), at(r + 2.5, a, h + 1.2));
        }
    }
}

void hair(SceneMaker& make, uint64_t triangles) {
    constexpr unsigned kPieces = 8;
    constexpr double kWidth = 0.0025;
    Chance chance;
    for (uint64_t strand = 0; strand < std::max<uint64_t>(1, triangles / (2 * kPieces)); ++strand) {
        Vec at = chance.direction(), along = normalized(at + 0.5 * chance.direction());
        const Vec side = kWidth * normalized(cross(along, chance.direction()));
        rt_u32 left = make.add_vertex(at - side), right = make.add_vertex(at + side);
        for (unsigned piece = 0; piece < kPieces; ++piece) {
            at = at + (1.0 / kPieces) * along;
            along = normalized(along + 0.15 * chance.direction() + Vec{0, -0.15, 0});
            const double rest = 1 - double(piece + 1) / kPieces;  // it ends in a point
            const rt_u32 next_left = make.add_vertex(at - rest * side), next_right = make.add_vertex(at + rest * side);
            make.add_triangle(left, right, next_right);
            if (rest > 0) make.add_triangle(left, next_right, next_left);
            left = next_left, right = next_right;
        }
    }
}

void city(SceneMaker& make, uint64_t triangles) {
    constexpr unsigned kKinds = 4, kLots = 40;
    Chance chance;
    rt_u32 houses[kKinds];
    for (rt_u32& house : houses) {
        const auto floors = static_cast<unsigned>(std::clamp<uint64_t>(triangles / (64 * kKinds), 2, 4096));
        const double height = chance.between(1.5, 5);
        // Each floor has a window on each side, which is set back: four bands of wall around it, and its pane.
        for (unsigned f = 0; f < floors; ++f) {
            const double low = height * f / floors, high = height * (f + 1) / floors, sill = low + 0.25 * (high - low),
                         lintel = high - 0.2 * (high - low);
            for (unsigned s = 0; s < 4; ++s) {
                const double c = std::cos(kTurn * s / 4), n = std::sin(kTurn * s / 4);
                const auto at = [&](double x, double y, double out) { return Vec{c * out - n * x, y, n * out + c * x}; };
                make.add_quad(at(-0.35, low, 0.35), at(0.35, low, 0.35), at(0.35, sill, 0.35), at(-0.35, sill, 0.35));
                make.add_quad(at(-0.35, lintel, 0.35), at(0.35, lintel, 0.35), at(0.35, high, 0.35), at(-0.35, high, 0.35));
                make.add_quad(at(-0.35, sill, 0.35), at(-0.2, sill, 0.35), at(-0.2, lintel, 0.35), at(-0.35, lintel, 0.35));
                make.add_quad(at(0.2, sill, 0.35), at(0.35, sill, 0.35), at(0.35, lintel, 0.35), at(0.2, lintel, 0.35));
                make.add_quad(at(-0.2, sill, 0.32), at(0.2, sill, 0.32), at(0.2, lintel, 0.32), at(-0.2, lintel, 0.32));
                make.add_quad(at(-0.2, sill, 0.35), at(0.2, sill, 0.35), at(0.2, sill, 0.32), at(-0.2, sill, 0.32));
                make.add_quad(at(-0.2, lintel, 0.32), at(0.2, lintel, 0.32), at(0.2, lintel, 0.35), at(-0.2, lintel, 0.35));
                make.add_quad(at(-0.2, sill, 0.35), at(-0.2, sill, 0.32), at(-0.2, lintel, 0.32), at(-0.2, lintel, 0.35));
            }
        }
        make.add_quad(Vec{-0.35, height, -0.35}, {-0.35, height, 0.35}, {0.35, height, 0.35}, {0.35, height, -0.35});
        house = make.end_mesh();
    }
    for (unsigned x = 0; x < kLots; ++x)
        for (unsigned z = 0; z < kLots; ++z) {
            const double tall = chance.between(0.4, 1.4),
                         turn = kTurn / 4 * std::floor(chance.between(0, 4)) + chance.between(-0.1, 0.1);
            Affine at = kIdentity;
            at[0] = at[10] = static_cast<float>(std::cos(turn));
            at[2] = static_cast<float>(std::sin(turn));
            at[8] = -at[2];
            at[5] = static_cast<float>(tall);
            at[3] = static_cast<float>(x) - 0.5f * kLots;
            at[11] = static_cast<float>(z) - 0.5f * kLots;
            make.place(houses[static_cast<size_t>(chance.between(0, kKinds))], at);
        }
    make.add_quad(Vec{-30, 0, -30}, {-30, 0, 30}, {30, 0, 30}, {30, 0, -30});
}

void height_field(SceneMaker& make, uint64_t triangles) {
    const auto side = static_cast<rt_u32>(std::clamp(std::sqrt(0.5 * double(triangles)), 1.0, 30000.0));
    make.add_grid({side, side, kCut023}, [&](rt_u32 i, rt_u32 k) {
        const double x = 4.0 * k / side - 2, z = 4.0 * i / side - 2;
        make.add_vertex(x, height_at(x, z), z);
    });
}

void soup(SceneMaker& make, uint64_t triangles) {
    Chance chance;
    const double size = 2 / std::cbrt(double(std::max<uint64_t>(1, triangles)));
    for (uint64_t i = 0; i < triangles; ++i) {
        const Vec at{chance.between(-1, 1), chance.between(-1, 1), chance.between(-1, 1)};
        rt_u32 corners[3];
        for (rt_u32& corner : corners) corner = make.add_vertex(at + size * chance.direction());
        make.add_triangle(corners[0], corners[1], corners[2]);
    }
}

void blocks(SceneMaker& make, uint64_t triangles) {
    const auto side = static_cast<unsigned>(std::max(1.0, std::sqrt(triangles / 12.0)));
    const float step = 2.0f / float(side);
    for (unsigned i = 0; i < side * side; ++i) {
        const float x = -1 + step * float(i % side), z = -1 + step * float(i / side), h = make.random();
        make.add_box({x, 0, z}, {x + step * (0.4f + 0.5f * make.random()), 0.02f + 0.8f * h * h * h, z + 0.8f * step});
    }
}

void mixed_soup(SceneMaker& make, uint64_t triangles) {
    make.add_soup({0, 0, 0}, 1, 0.1f, triangles);
}

void needles(SceneMaker& make, uint64_t triangles) {
    for (uint64_t i = 0; i < triangles; ++i) {
        const Point a = make.around({0, 0, 0}, 1), b = make.around(a, 0.5f), c = make.around(a, 0.004f);
        make.add_triangle(a, b, c);
    }
}

void teapots(SceneMaker& make, uint64_t triangles) {
    make.add_box({-20, -20, -20}, {20, 20, 20});
    constexpr unsigned kBalls = 5;
    const auto rings = static_cast<int>(std::max(3.0, std::sqrt(triangles / (4.0 * kBalls))));
    for (unsigned i = 0; i < kBalls; ++i) make.add_ball(make.around({0, 0, 0}, 1), 0.2f, 2 * rings, rings);
}

void crowds(SceneMaker& make, uint64_t triangles) {
    for (uint64_t i = 0; i < triangles; ++i) {
        const unsigned crowd = i % 7;
        // A tenth lies anywhere. Crowd k is 0.7^k as wide as the first one.
        const bool alone = make.random() < 0.1f;
        const float angle = 2.4f * float(crowd), wide = alone ? 1 : 0.25f * std::pow(0.7f, float(crowd));
        const Point middle = {0.7f * std::cos(angle), 0.2f * float(crowd) - 0.6f, 0.7f * std::sin(angle)};
        const Point at = make.around(alone ? Point{0, 0, 0} : middle, wide);
        const float size = wide * 0.5f * std::pow(0.02f, make.random());
        make.add_triangle(at, make.around(at, size), make.around(at, size));
    }
}

}  // namespace made

}  // namespace clarity
