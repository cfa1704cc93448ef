#include "statements.hpp"

#include <algorithm>
#include <cmath>

#include "looks.hpp"
#include "shapes.hpp"
#include "textures.hpp"

namespace scene_format {
namespace {

// Below, one function for each statement. Their reference is docs/scene_format.md.

constexpr float kNoLimit = kMaxNumber;

void add_item(Document& document, ItemKind kind, size_t index, Position position) {
    document.items.push_back({kind, static_cast<uint32_t>(index), position});
}

void once(Statement& s, Position first) {
    if (first.line != 0) {
        throw StatementError{s.position(), "statement " + in_quotes(s.word()) + " for the second time; the first is in line " +
                                               std::to_string(first.line)};
    }
}

void read_camera(Statement& s, Document& document, Diagnostics&) {
    enum { kEye, kTarget, kUp, kFov, kAperture, kFocus };
    s.expect_keys({{"eye"}, {"target"}, {"up"}, {"fov"}, {"aperture"}, {"focus"}});
    Camera camera;
    camera.name = s.name("the camera's name");
    while (!s.done()) {
        switch (s.key()) {
            case kEye:
                camera.eye = s.vector("`eye` (x y z)");
                break;
            case kTarget:
                camera.target = s.vector("`target` (x y z)");
                break;
            case kUp:
                camera.up = s.direction("`up` (x y z)");
                break;
            case kFov:
                camera.fov_deg = s.number_between("`fov` (vertical, degrees)", 0.1f, 179.0f);
                break;
            case kAperture:
                camera.aperture = s.number_between("`aperture` (diameter of the lens)", 0, kNoLimit);
                break;
            case kFocus:
                camera.focus = s.number_between("`focus` (distance along the view)", 0, kNoLimit);
                break;
        }
    }
    std::array<double, 3> view{};
    for (size_t i = 0; i < 3; ++i) view[i] = double{camera.target[i]} - double{camera.eye[i]};
    const double distance = std::hypot(view[0], view[1], view[2]);
    if (!(distance > 0))
        throw StatementError{camera.name.position, "`eye` and `target` are the same point; expected different ones"};
    const Vec3& up = camera.up;
    const double side =
        std::hypot(view[1] * up[2] - view[2] * up[1], view[2] * up[0] - view[0] * up[2], view[0] * up[1] - view[1] * up[0]);
    if (!(side > 1e-6 * distance)) {
        throw StatementError{camera.name.position,
                             "the camera looks along its `up` vector; expected another `up` (0 0 -1, say, to look down)"};
    }
    document.cameras.push_back(std::move(camera));
}

void read_background(Statement& s, Document& document, Diagnostics&) {
    once(s, document.background_position);
    const Vec3 color = s.color("`background` (r g b)", kNoLimit);
    s.expect_end();
    document.background = color;
    document.background_position = s.position();
}

void read_ambient(Statement& s, Document& document, Diagnostics&) {
    once(s, document.ambient_position);
    const Vec3 color = s.color("`ambient` (r g b)", kNoLimit);
    s.expect_end();
    document.ambient = color;
    document.ambient_position = s.position();
}

void read_sphere(Statement& s, Document& document, Diagnostics&) {
    enum { kCenter, kRadius, kMaterial };
    s.expect_keys({{"center"}, {"radius"}, {"material"}});
    Sphere sphere;
    while (!s.done()) {
        switch (s.key()) {
            case kCenter:
                sphere.center = s.vector("`center` (x y z)");
                break;
            case kRadius:
                sphere.radius = s.number("`radius`");
                if (!(sphere.radius > 0)) s.fail_at_last("a radius is positive; expected a number greater than 0 for `radius`");
                break;
            case kMaterial:
                sphere.material = s.name("a material's name");
                break;
        }
    }
    add_item(document, ItemKind::sphere, document.spheres.size(), s.position());
    document.spheres.push_back(std::move(sphere));
}

void read_plane(Statement& s, Document& document, Diagnostics&) {
    enum { kNormal, kOffset, kMaterial };
    s.expect_keys({{"normal"}, {"offset"}, {"material"}});
    Plane plane;
    while (!s.done()) {
        switch (s.key()) {
            case kNormal:
                plane.normal = s.direction("`normal` (x y z)");
                break;
            case kOffset:
                plane.offset = s.number("`offset` (distance from the origin along the normal)");
                break;
            case kMaterial:
                plane.material = s.name("a material's name");
                break;
        }
    }
    add_item(document, ItemKind::plane, document.planes.size(), s.position());
    document.planes.push_back(std::move(plane));
}

void read_polygon(Statement& s, Document& document, Diagnostics&) {
    enum { kVertices, kMaterial };
    s.expect_keys({{"vertices"}, {"material"}});
    Polygon polygon;
    Position start = s.position();
    while (!s.done()) {
        switch (s.key()) {
            case kVertices:
                start = s.last();
                polygon.corners = s.points("`vertices` (x y z of each corner)");
                break;
            case kMaterial:
                polygon.material = s.name("a material's name");
                break;
        }
    }
    if (polygon.corners.empty())
        throw StatementError{start, "a polygon without `vertices`; expected x y z of 3 corners or more"};
    if (const std::string fault = polygon_fault(polygon.corners); !fault.empty()) throw StatementError{start, fault};
    add_item(document, ItemKind::polygon, document.polygons.size(), s.position());
    document.polygons.push_back(std::move(polygon));
}

void read_triangle(Statement& s, Document& document, Diagnostics& diagnostics) {
    enum { kVertices, kMaterial };
    s.expect_keys({{"vertices"}, {"material"}});
    Triangle triangle;
    Position start = s.position();
    while (!s.done()) {
        switch (s.key()) {
            case kVertices: {
                start = s.last();
                const std::vector<float> corners = s.points("`vertices` (x y z of each corner)");
                if (corners.size() != 9) {
                    throw StatementError{
                        start, std::to_string(corners.size() / 3) + " corners; a triangle has 3 (`polygon` takes more)"};
                }
                std::copy(corners.begin(), corners.end(), triangle.corners.begin());
                break;
            }
            case kMaterial:
                triangle.material = s.name("a material's name");
                break;
        }
    }
    if (!s.given(kVertices)) throw StatementError{start, "a triangle without `vertices`; expected x y z of 3 corners"};
    // Meshes contain such triangles too, and no ray hits them. One warning per file is enough.
    if (triangle_is_degenerate(triangle.corners) && !document.has_degenerate_triangle) {
        diagnostics.warning(start, "a triangle without area is invisible (further ones are not reported)");
        document.has_degenerate_triangle = true;
    }
    add_item(document, ItemKind::triangle, document.triangles.size(), s.position());
    document.triangles.push_back(std::move(triangle));
}

void read_load(Statement& s, Document& document, Diagnostics&) {
    enum { kTranslate, kRotate, kScale, kMaterial, kName };
    s.expect_keys({{"translate"}, {"rotate", true}, {"scale"}, {"material"}, {"name"}});
    Load load;
    load.path = s.path("the file to load");
    load.position = s.last();
    StatedTransform& placement = load.placement;
    while (!s.done()) {
        switch (s.key()) {
            case kTranslate:
                placement.translate(s.vector("`translate` (x y z)"));
                break;
            case kRotate: {
                const Vec3 axis = s.direction("`rotate` (axis x y z, then degrees)");
                placement.rotate(axis, s.number("`rotate`'s angle (degrees)"));
                break;
            }
            case kScale:
                placement.scale(s.scale("`scale` (one factor, or x y z)"));
                break;
            case kMaterial:
                load.material = s.name("a material's name");
                break;
            case kName:
                load.name = s.name("the object's name");
                break;
        }
    }
    add_item(document, ItemKind::load, document.loads.size(), s.position());
    document.loads.push_back(std::move(load));
}

void read_animate(Statement& s, Document& document, Diagnostics&) {
    Animation animation;
    animation.target = s.name("the name of a loaded object, a camera or a light");
    animation.motion = static_cast<Animation::Motion>(s.choice("motion", {"translate", "rotate", "scale", "fov"}));
    const bool rotates = animation.motion == Animation::Motion::rotate;
    constexpr const char* what[] = {"`translate` (time x y z)", "`rotate` (time, axis x y z, degrees)", "`scale` (time x y z)",
                                    "`fov` (time degrees)"};
    const char* expected = what[static_cast<int>(animation.motion)];
    const size_t count = animation.numbers_per_key();
    std::vector<float>& numbers = animation.numbers;
    do {
        for (size_t i = 0; i < count; ++i) {
            numbers.push_back(s.number(expected, i, count));
            if (i == 0 && numbers.size() > count && !(numbers.back() > numbers[numbers.size() - 1 - count]))
                s.fail_at_last("times must grow; expected a later time than the one before");
        }
        if (animation.motion == Animation::Motion::fov && !(numbers.back() > 0 && numbers.back() < 180))
            s.fail_at_last("a field of view is between 0 and 180 degrees");
        if (!rotates) continue;
        float* axis = numbers.data() + numbers.size() - count + 1;
        const float length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
        if (!(length > 0)) s.fail_at_last("the zero vector has no direction; expected another axis for `rotate`");
        for (int i = 0; i < 3; ++i) axis[i] /= length;
    } while (!s.done());
    document.animations.push_back(std::move(animation));
}

void read_instance_edits(Statement& s, const std::string& prefix, Document& document) {
    enum { kTranslate, kRotate, kScale, kHidden, kMask };
    s.expect_keys({{"translate"}, {"rotate"}, {"scale"}, {"hidden"}, {"mask"}});
    const auto add = [&](const char* part, const std::string& value) {
        document.edits.push_back({prefix + part, value, s.position()});
    };
    while (!s.done()) {
        switch (s.key()) {
            case kTranslate:
                add("translate", text_of(s.vector("`translate` (x y z)")));
                break;
            case kRotate:
                add("rotate", text_of(s.vector("`rotate` (degrees about x, y, z)")));
                break;
            case kScale:
                add("scale", text_of(s.scale("`scale` (one factor, or x y z)")));
                break;
            case kHidden:
                add("hidden", s.choice("value of `hidden`", {"0", "1"}) == 1 ? "1" : "0");
                break;
            case kMask: {
                const float mask = s.number_between("`mask` (bits of the rays that hit it)", 0, 255);
                if (mask != std::floor(mask))
                    s.fail_at_last("expected a whole number: a sum of 1, 2, 4 and more bits, up to 255");
                add("mask", std::to_string(static_cast<int>(mask)));
                break;
            }
        }
    }
}

void read_edit(Statement& s, Document& document, Diagnostics&) {
    const size_t of = s.choice("object to edit", {"instance", "material", "light", "sky"});
    if (of == 3) return read_sky_edits(s, document);
    const float number = s.number_between("its number, counted from 0", 0, 1e9f);
    if (number != std::floor(number)) s.fail_at_last("expected a whole number, counted from 0");
    const std::string count = std::to_string(static_cast<uint32_t>(number));
    if (of == 0) return read_instance_edits(s, "instance." + count + ".", document);
    if (of == 1) return read_material_edits(s, "material." + count + ".", document);
    read_light_edits(s, "light." + count, document);
}

}  // namespace

const std::vector<StatementRow>& statements() {
    static const std::vector<StatementRow> table = {
        {"camera", read_camera},     {"light", read_light},     {"background", read_background}, {"ambient", read_ambient},
        {"material", read_material}, {"sphere", read_sphere},   {"plane", read_plane},           {"polygon", read_polygon},
        {"triangle", read_triangle}, {"load", read_load},       {"animate", read_animate},       {"edit", read_edit},
        {"sky", read_sky},           {"texture", read_texture},
    };
    return table;
}

}  // namespace scene_format
