#include "bench/suites/zoo_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/angle.hpp"
#include "bench/suites/mesh_writer.hpp"
#include "bench/suites/ray_sets.hpp"
#include "scene/vec.hpp"

namespace clarity::bench {
namespace {

constexpr double kTurn = 2 * kPi;

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

void add_stadium(uint64_t triangles, Scene& scene) {
    const Bounds box = scene.bounds();
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
    MeshWriter mesh(scene);
    const auto at = [&](double radius, double angle, double height) {
        return middle + size * Vec{1.3 * radius * std::cos(angle), height, radius * std::sin(angle)};
    };
    const unsigned tiers = 24;
    const auto parts = static_cast<unsigned>(std::clamp<uint64_t>(triangles / (4 * tiers), 12, 4096));
    // The pitch is two triangles, and its corners are under the stands. A fan of slivers around the middle would put hundreds
    // of boxes over one another exactly where the camera looks.
    const auto corner = [&](double x, double z) { return middle + size * Vec{52 * x, 0, 40 * z}; };
    mesh.quad(corner(-1, -1), corner(-1, 1), corner(1, 1), corner(1, -1));
    for (unsigned i = 0; i < parts; ++i) {
        const double a = kTurn * i / parts, b = kTurn * (i + 1) / parts;
        for (unsigned t = 0; t < tiers; ++t) {  // a step's front and its seat
            const double r = 40 + 2.5 * t, h = 1.2 * t;
            mesh.quad(at(r, a, h), at(r, b, h), at(r, b, h + 1.2), at(r, a, h + 1.2));
            mesh.quad(at(r, a, h + 1.2), at(r, b, h + 1.2), at(r + 2.5, b, h + 1.2), at(r + 2.5, a, h + 1.2));
        }
    }
    mesh.end_and_place();
}

void add_hair(uint64_t triangles, Scene& scene) {
    constexpr unsigned kPieces = 8;
    constexpr double kWidth = 0.0025;
    Chance chance;
    MeshWriter mesh(scene);
    for (uint64_t strand = 0; strand < std::max<uint64_t>(1, triangles / (2 * kPieces)); ++strand) {
        Vec at = chance.direction(), along = clarity::normalized(at + 0.5 * chance.direction());
        const Vec side = kWidth * clarity::normalized(cross(along, chance.direction()));
        rt_u32 left = mesh.vertex(at - side), right = mesh.vertex(at + side);
        for (unsigned piece = 0; piece < kPieces; ++piece) {
            at = at + (1.0 / kPieces) * along;
            along = clarity::normalized(along + 0.15 * chance.direction() + Vec{0, -0.15, 0});
            const double rest = 1 - double(piece + 1) / kPieces;  // it ends in a point
            const rt_u32 next_left = mesh.vertex(at - rest * side), next_right = mesh.vertex(at + rest * side);
            mesh.triangle(left, right, next_right);
            if (rest > 0) mesh.triangle(left, next_right, next_left);
            left = next_left, right = next_right;
        }
    }
    mesh.end_and_place();
}

void add_city(uint64_t triangles, Scene& scene) {
    constexpr unsigned kKinds = 4, kLots = 40;
    Chance chance;
    rt_u32 houses[kKinds];
    for (rt_u32& house : houses) {
        MeshWriter mesh(scene);
        const auto floors = static_cast<unsigned>(std::clamp<uint64_t>(triangles / (64 * kKinds), 2, 4096));
        const double height = chance.between(1.5, 5);
        // Each floor has a window on each side, which is set back: four bands of wall around it, and its pane.
        for (unsigned f = 0; f < floors; ++f) {
            const double low = height * f / floors, high = height * (f + 1) / floors, sill = low + 0.25 * (high - low),
                         lintel = high - 0.2 * (high - low);
            for (unsigned s = 0; s < 4; ++s) {
                const double c = std::cos(kTurn * s / 4), n = std::sin(kTurn * s / 4);
                const auto at = [&](double x, double y, double out) { return Vec{c * out - n * x, y, n * out + c * x}; };
                mesh.quad(at(-0.35, low, 0.35), at(0.35, low, 0.35), at(0.35, sill, 0.35), at(-0.35, sill, 0.35));
                mesh.quad(at(-0.35, lintel, 0.35), at(0.35, lintel, 0.35), at(0.35, high, 0.35), at(-0.35, high, 0.35));
                mesh.quad(at(-0.35, sill, 0.35), at(-0.2, sill, 0.35), at(-0.2, lintel, 0.35), at(-0.35, lintel, 0.35));
                mesh.quad(at(0.2, sill, 0.35), at(0.35, sill, 0.35), at(0.35, lintel, 0.35), at(0.2, lintel, 0.35));
                mesh.quad(at(-0.2, sill, 0.32), at(0.2, sill, 0.32), at(0.2, lintel, 0.32), at(-0.2, lintel, 0.32));
                mesh.quad(at(-0.2, sill, 0.35), at(0.2, sill, 0.35), at(0.2, sill, 0.32), at(-0.2, sill, 0.32));
                mesh.quad(at(-0.2, lintel, 0.32), at(0.2, lintel, 0.32), at(0.2, lintel, 0.35), at(-0.2, lintel, 0.35));
                mesh.quad(at(-0.2, sill, 0.35), at(-0.2, sill, 0.32), at(-0.2, lintel, 0.32), at(-0.2, lintel, 0.35));
            }
        }
        mesh.quad({-0.35, height, -0.35}, {-0.35, height, 0.35}, {0.35, height, 0.35}, {0.35, height, -0.35});
        house = mesh.end();
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
            MeshWriter::place(scene, houses[static_cast<size_t>(chance.between(0, kKinds))], at);
        }
    MeshWriter ground(scene);
    ground.quad({-30, 0, -30}, {-30, 0, 30}, {30, 0, 30}, {30, 0, -30});
    ground.end_and_place();
}

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

void add_height_field(uint64_t triangles, Scene& scene) {
    MeshWriter mesh(scene);
    const auto side = static_cast<rt_u32>(std::clamp(std::sqrt(0.5 * double(triangles)), 1.0, 30000.0));
    for (rt_u32 i = 0; i <= side; ++i)
        for (rt_u32 k = 0; k <= side; ++k) {
            const double x = 4.0 * k / side - 2, z = 4.0 * i / side - 2;
            const rt_u32 here = mesh.vertex({x, height_at(x, z), z});
            if (i == 0 || k == 0) continue;
            const rt_u32 before = here - side - 1;
            mesh.triangle(before - 1, here - 1, here);
            mesh.triangle(before - 1, here, before);
        }
    mesh.end_and_place();
}

void add_soup(uint64_t triangles, Scene& scene) {
    Chance chance;
    MeshWriter mesh(scene);
    const double size = 2 / std::cbrt(double(std::max<uint64_t>(1, triangles)));
    for (uint64_t i = 0; i < triangles; ++i) {
        const Vec at{chance.between(-1, 1), chance.between(-1, 1), chance.between(-1, 1)};
        rt_u32 corners[3];
        for (rt_u32& corner : corners) corner = mesh.vertex(at + size * chance.direction());
        mesh.triangle(corners[0], corners[1], corners[2]);
    }
    mesh.end_and_place();
}

}  // namespace

void add_zoo_scene(const std::string& name, uint64_t triangles, Scene& scene) {
    static constexpr struct {
        const char* name;
        void (*add)(uint64_t triangles, Scene& scene);
    } kRows[] = {{"stadium", add_stadium},
                 {"hair", add_hair},
                 {"city", add_city},
                 {"height field", add_height_field},
                 {"soup", add_soup}};
    for (const auto& row : kRows)
        if (name == row.name) return row.add(triangles, scene);
    throw std::out_of_range("no scene `" + name + "`");
}

}  // namespace clarity::bench
