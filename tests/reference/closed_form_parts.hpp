// closed_form_parts.hpp -- what the scenes of closed forms are made of.
#pragma once
#include <string>

#include "scene/scene.hpp"
#include "scene/vec.hpp"
#include "support/generated.hpp"
#include "view/view.hpp"

namespace clarity::reference::parts {

constexpr double kNarrow_deg = 0.01;

rt_material material(rt_u32 model, float color, float roughness = 0, rt_u32 flags = 0);
rt_material lambert(float albedo, float emission = 0);
rt_material dielectric(float ior, float roughness = 0);

rt_light light(rt_u32 kind, const Vec& position, float color, rt_u32 flags = 0);
// A rectangle of half sides a and b across y = height that shines down, or up.
rt_light rect(double height, float a, float b, float radiance, bool down = true);
rt_light disc(float height, float radius, float radiance);
rt_light sphere(const Vec& middle, float radius, float radiance);
rt_light sun(double angle_from_y_deg, double diameter_deg, float irradiance);

// Looks at a point from a distance, against `from`, a unit vector.
View looking_at(const Vec& point, const Vec& from, double distance, float background, double fov_deg = kNarrow_deg);
// At an angle from the y axis.
Vec slanted(double deg);

Scene empty();
Scene ground(const rt_material& m);
Scene ball(const rt_material& m);
void add_quad(TriangleMesh& mesh, const Vec& corner, const Vec& a, const Vec& b);
Scene of_mesh(const TriangleMesh& mesh, const rt_material& m);
// The unit cube without its ceiling, which is a light.
Scene room(const rt_material& m);
// All of a face of it, in pixels of equal area.
View of_face(const Vec& middle, const Vec& normal);
// A closed slab from y = 0 to 1 that is 200 wide.
Scene slab(const rt_material& m);
// A ball of radius 1 that just fills the width of the picture, from so far away that every cosine^2 has the same share. Around
// it is the sky, of radiance 1: the picture's mean for a mean `albedo` of the ball.
View whole_ball();
double with_corners(double albedo);
Scene under_gradient(Scene scene, float zenith, float horizon);
// A picture of the lobe max(d.s, 0)^n, s at an angle from the zenith, towards +Z.
Scene under_lobe(Scene scene, double deg, double n, rt_u32 height);

// A number as text.
std::string text(double number);

}  // namespace clarity::reference::parts
