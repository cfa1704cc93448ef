// vec3.hpp -- vectors in double precision, for rays and meshes made on the host.
#pragma once
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace clarity::bench {

using Vec3 = glm::dvec3;

// Unit vector. Returns `otherwise` for the zero vector, for which glm::normalize() returns NaN.
inline Vec3 normalized(const Vec3& a, const Vec3& otherwise) {
    const double length = glm::length(a);
    return length > 0 ? (1 / length) * a : otherwise;
}

}  // namespace clarity::bench
