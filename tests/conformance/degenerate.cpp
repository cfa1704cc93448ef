#include "conformance/degenerate.hpp"

#include <cmath>

namespace clarity::test {

Scene degenerate_scene() {
    TriangleMesh mesh;
    TriangleMesh cube = box(1);
    mesh.add(cube);
    mesh.add(cube);  // duplicates: either may be named, since t is the same
    cube.transform(0.5, {2, 0.5, 0});
    mesh.add(cube);  // partly in the same plane as a side of the first box

    // Triangles that are points or needles along each axis, in front of the boxes.
    for (int axis = 0; axis < 3; ++axis) {
        // Not on the grid of pixels, because a ray that hits a needle exactly may see it or not.
        std::array<double, 3> a{-1.53, 1.57, 1.51}, b = a;
        b[axis] += 1;
        const rt_u32 p = mesh.add_vertex(a[0], a[1], a[2]), q = mesh.add_vertex(b[0], b[1], b[2]);
        const rt_u32 middle = mesh.add_vertex(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2]));
        mesh.add_triangle(p, p, p);
        mesh.add_triangle(p, q, q);
        mesh.add_triangle(p, middle, q);
    }

    // A wall of axis-parallel squares. Their corners are powers of two, so that the central rays run along their edges.
    for (int x = -4; x < 4; ++x)
        for (int y = -4; y < 4; ++y) {
            const double left = x, low = y;
            mesh.add_quad(Vec{left, low, -4}, {left + 1, low, -4}, {left + 1, low + 1, -4}, {left, low + 1, -4});
        }

    // Tiny triangles, and a floor that extends far beyond everything else.
    for (int i = 0; i < 64; ++i) {
        const double x = -2 + 1e-3 * (i % 8), y = 0.2 + 1e-3 * (i / 8);
        const rt_u32 a = mesh.add_vertex(x, y, 2), b = mesh.add_vertex(x + 1e-4, y, 2), c = mesh.add_vertex(x, y + 1e-4, 2);
        mesh.add_triangle(a, b, c);
    }
    constexpr double kFar = 1e6;
    const rt_u32 a = mesh.add_vertex(-kFar, -1, -kFar), b = mesh.add_vertex(kFar, -1, -kFar),
                 c = mesh.add_vertex(kFar, -1, kFar), d = mesh.add_vertex(-kFar, -1, kFar);
    mesh.add_triangle(a, c, b);
    mesh.add_triangle(a, d, c);
    return scene_of(mesh);
}

// Looks straight along -z from a round position. With an odd number of pixels, the middle row and column then lie in the planes
// of the axes.
View view_of_degenerate() {
    return view_from({0, 0, 8}, {0, 0, 0}, 60);
}

}  // namespace clarity::test
