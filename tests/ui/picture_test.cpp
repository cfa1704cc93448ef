// Tests of the overlays of pictures, as far as they need no screen.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <limits>

#include "ui/hud/picture_hud.hpp"
#include "ui/overlay/light_handles.hpp"
#include "ui/overlay/line_quads.hpp"
#include "ui/overlay/move_handles.hpp"
#include "ui/overlay/ray_lines.hpp"
#include "ui/threads/picture.hpp"
#include "ui/viewport/picture_captions.hpp"
#include "ui/viewport/picture_layout.hpp"

namespace clarity::ui {
namespace {

const Rect kArea{100, 50, 800, 600};

Camera some_camera() {
    Camera camera;
    camera.eye = {3, 2, 6};
    camera.target = {0, 1, -1};
    camera.fov_y_rad = 0.9f;
    return camera;
}

glm::vec3 vec(const std::array<float, 3>& a) {
    return {a[0], a[1], a[2]};
}

TEST(Projection, PutsTheTargetInTheMiddle) {
    const Projection projection(kArea, some_camera());
    const auto place = projection.place({0, 1, -1});
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->x, 500, 0.01);
    EXPECT_NEAR(place->y, 350, 0.01);
    EXPECT_FALSE(projection.place({6, 3, 13}));  // behind the eye
}

TEST(Projection, RaysGoThroughThePlacesOfTheirPoints) {
    const Projection projection(kArea, some_camera());
    for (const glm::vec2 place : {glm::vec2(100, 50), glm::vec2(899, 50), glm::vec2(500, 350), glm::vec2(321, 600)}) {
        const glm::vec3 ray = projection.ray(place);
        EXPECT_NEAR(glm::length(ray), 1, 1e-5);
        for (const float t : {0.5f, 7.0f, 90.0f}) {
            const auto back = projection.place(projection.eye() + ray * t);
            ASSERT_TRUE(back);
            EXPECT_NEAR(back->x, place.x, 0.05);
            EXPECT_NEAR(back->y, place.y, 0.05);
        }
    }
}

TEST(LineQuads, ALineThroughTheEyeIsClippedThere) {
    const Projection projection(kArea, some_camera());
    const glm::vec3 ahead = projection.ray({700, 200});
    LineList lines;
    lines.line(projection.eye() - ahead * 50.0f + glm::vec3(0, 0.4f, 0), projection.eye() + ahead * 50.0f, 0xFFFFFFFFu, 2);
    std::vector<LineVertex> vertices;
    append_quads(lines, projection, 1, vertices);
    ASSERT_EQ(vertices.size(), 4u);
    for (const LineVertex& v : vertices) {
        EXPECT_TRUE(std::isfinite(v.x) && std::isfinite(v.y));
        EXPECT_GE(v.x, -5);
        EXPECT_LE(v.x, 805);
        EXPECT_GE(v.y, -5);
        EXPECT_LE(v.y, 605);
        EXPECT_GT(v.inv_depth, 0);
    }
    // Clipping does not move the far end.
    EXPECT_NEAR((vertices[2].x + vertices[3].x) / 2, 600, 1);
    EXPECT_NEAR((vertices[2].y + vertices[3].y) / 2, 150, 1);
}

TEST(LineQuads, InvisibleLinesHaveNone) {
    const Projection projection(kArea, some_camera());
    LineList lines;
    lines.line({6, 3, 13}, {7, 3, 14}, ~0u, 1);                                        // behind the eye
    lines.line({500, 0, -1}, {500, 9, -1}, ~0u, 1);                                    // far to the side
    lines.line({0, 1, -1}, {0, 1, -1}, ~0u, 1);                                        // a point
    lines.line({0, 1, -1}, {std::numeric_limits<float>::quiet_NaN(), 1, -1}, ~0u, 1);  // not a position
    std::vector<LineVertex> vertices;
    append_quads(lines, projection, 1, vertices);
    EXPECT_TRUE(vertices.empty());
}

// The shader computes the distance of each point from 1 / depth, which is linear on the screen.
TEST(LineQuads, DistanceAlongALineEqualsThePoints) {
    const Camera camera = some_camera();
    const Projection projection(kArea, camera);
    const glm::vec3 a(-2, 0, -3), b(1, 2, 3);
    LineList lines;
    lines.line(a, b, ~0u, 1);
    std::vector<LineVertex> vertices;
    append_quads(lines, projection, 1, vertices);
    ASSERT_EQ(vertices.size(), 4u);
    const auto middle = [&](size_t i) {
        return glm::vec2((vertices[i].x + vertices[i + 1].x) / 2, (vertices[i].y + vertices[i + 1].y) / 2);
    };
    for (const float share : {0.0f, 0.3f, 0.75f, 1.0f}) {
        const glm::vec2 at = middle(0) + (middle(2) - middle(0)) * share;
        const float inverse = vertices[0].inv_depth + (vertices[2].inv_depth - vertices[0].inv_depth) * share;
        const glm::vec2 slope = (at / glm::vec2(kArea.width, kArea.height) * 2.0f - 1.0f) * projection.half_size();
        const float distance = std::sqrt(1 + glm::dot(slope, slope)) / inverse;
        // The point at this distance along the ray must lie on the line.
        const glm::vec3 point = projection.eye() + projection.ray(at + glm::vec2(kArea.x, kArea.y)) * distance;
        const glm::vec3 along = glm::normalize(b - a);
        EXPECT_LT(glm::length(glm::cross(point - a, along)), 2e-3f) << share;
    }
}

TEST(LineList, ABoxHasTwelveEdges) {
    std::array<std::array<float, 3>, 8> corners;
    for (unsigned i = 0; i < 8; ++i) corners[i] = {i & 1 ? 1.0f : 0.0f, i & 2 ? 2.0f : 0.0f, i & 4 ? 3.0f : 0.0f};
    LineList lines;
    lines.box(corners, 1, 1);
    ASSERT_EQ(lines.size(), 12u);
    float total = 0;
    for (const Line& line : lines.lines()) total += glm::length(line.b - line.a);
    EXPECT_NEAR(total, 4 * (1 + 2 + 3), 1e-5);
}

TEST(LineList, ASphereIsSeenByItsOutline) {
    const glm::vec3 center(1, 2, 3), eye(4, 2, 9);
    const float radius = 1.5f;
    LineList lines;
    lines.outline(center, radius, eye, 24, 1, 1);
    ASSERT_EQ(lines.size(), 24u);
    for (const Line& line : lines.lines()) {
        EXPECT_NEAR(glm::length(line.a - center), radius, 1e-4);
        // The line of sight touches the sphere: it is perpendicular to the radius.
        EXPECT_NEAR(glm::dot(line.a - center, eye - line.a), 0, 1e-3);
    }
    EXPECT_EQ(lines.lines().back().b, lines.lines().front().a);
    lines.clear();
    lines.outline(center, radius, center + glm::vec3(0, 1, 0), 24, 1, 1);
    EXPECT_TRUE(lines.empty());  // from inside the sphere
}

TEST(Layout, WipeSharesOnePlace) {
    const auto places = lay_out_pictures({0, 0, 1000, 500}, 1.5f, true, CompareMode::wipe, 0.25f, 40, 0);
    ASSERT_EQ(places.size(), 2u);
    EXPECT_EQ(places[0].area.x, places[1].area.x);
    EXPECT_NEAR(places[0].shown.width + places[1].shown.width, places[0].area.width, 1e-3);
    EXPECT_NEAR(places[0].shown.width, places[0].area.width / 4, 1);
    for (const float wipe : {-3.0f, 0.0f, 1.0f, 7.0f})
        for (const auto& place : lay_out_pictures({0, 0, 1000, 500}, 1.5f, true, CompareMode::wipe, wipe, 40, 0)) {
            EXPECT_GE(place.shown.width, 0);
            EXPECT_LE(place.shown.x + place.shown.width, place.area.x + place.area.width + 1e-3);
        }
}

TEST(Layout, SideBySideLeavesRoomForCaptions) {
    const Rect room{10, 20, 900, 700};
    for (const float aspect : {0.3f, 1.0f, 1.7778f, 8.0f}) {
        const auto places = lay_out_pictures(room, aspect, true, CompareMode::side_by_side, 0.5f, 60, 120);
        ASSERT_EQ(places.size(), 2u);
        EXPECT_GE(places[0].area.y, room.y + 60);
        EXPECT_LE(places[0].area.y + places[0].area.height, room.y + room.height);
        EXPECT_LT(places[0].area.x + places[0].area.width, places[1].area.x);
        EXPECT_LE(places[1].area.x + places[1].area.width, room.x + room.width);
        EXPECT_NEAR(places[0].area.width / places[0].area.height, aspect, aspect * 0.05);
    }
    const auto wide = lay_out_pictures(room, 2, true, CompareMode::side_by_side, 0.5f, 60, 120);
    EXPECT_GE(room.y + room.height - wide[0].area.y - wide[0].area.height, 120);
}

TEST(Layout, WithoutAComparisonOnlyTheMainSideIsShown) {
    const auto places = lay_out_pictures({0, 0, 100, 100}, 1, false, CompareMode::side_by_side, 0.5f, 10, 10);
    ASSERT_EQ(places.size(), 1u);
    EXPECT_EQ(places[0].side(), 0u);
}

TEST(Layout, PixelsUnderTheMouse) {
    unsigned x = 9, y = 9;
    EXPECT_TRUE(pixel_at({10, 10, 200, 100}, {10, 10}, 400, 200, x, y));
    EXPECT_EQ(x + y, 0u);
    EXPECT_TRUE(pixel_at({10, 10, 200, 100}, {209.9f, 109.9f}, 400, 200, x, y));
    EXPECT_EQ(x, 399u);
    EXPECT_EQ(y, 199u);
    EXPECT_FALSE(pixel_at({10, 10, 200, 100}, {9, 50}, 400, 200, x, y));
    EXPECT_FALSE(pixel_at({10, 10, 200, 100}, {50, 50}, 0, 0, x, y));
}

TEST(Cards, NeverOverlap) {
    for (const float width : {150.0f, 400.0f, 900.0f}) {
        HudStack stack({20, 30, width, 300}, 10, 120);
        std::vector<Rect> taken;
        for (int i = 0; i < 24; ++i) {
            const auto corner = static_cast<Corner>(i % 4);
            const float card_width = std::min(stack.max_width(), 100.0f + 20 * static_cast<float>(i % 3));
            if (const auto card = stack.take(corner, card_width, 40)) taken.push_back(*card);
        }
        EXPECT_GE(taken.size(), 4u);
        for (size_t i = 0; i < taken.size(); ++i) {
            EXPECT_GE(taken[i].x, 20);
            EXPECT_LE(taken[i].x + taken[i].width, 20 + width);
            EXPECT_GE(taken[i].y, 30);
            EXPECT_LE(taken[i].y + taken[i].height, 330);
            for (size_t k = 0; k < i; ++k) {
                const Rect &a = taken[i], &b = taken[k];
                EXPECT_FALSE(a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height);
            }
        }
    }
}

DesiredLight light_at(const glm::vec3& position, rt_u32 kind) {
    DesiredLight light;
    light.values.kind = kind;
    for (int i = 0; i < 3; ++i) light.values.position[i] = position[i];
    return light;
}

TEST(LightHandles, APointLightFollowsTheMouseAcrossTheView) {
    const Projection projection(kArea, some_camera());
    DesiredLight light = light_at({0.5f, 1.5f, 0}, RT_LIGHT_POINT);
    const float depth = projection.to_camera({0.5f, 1.5f, 0}).z;
    drag_point_light(light.values, projection, {630, 210});
    const auto handles = light_handles(projection, {light});
    ASSERT_EQ(handles.size(), 1u);
    EXPECT_EQ(handles[0].kind, LightHandle::Kind::point);
    EXPECT_NEAR(handles[0].place.x, 630, 0.05);
    EXPECT_NEAR(handles[0].place.y, 210, 0.05);
    const glm::vec3 now(light.values.position[0], light.values.position[1], light.values.position[2]);
    EXPECT_NEAR(projection.to_camera(now).z, depth, 1e-4);
    push_point_light(light.values, projection, 2);
    const auto pushed = light_handles(projection, {light});
    EXPECT_NEAR(pushed[0].place.x, 630, 0.05);
    EXPECT_NEAR(pushed[0].distance, 2 * handles[0].distance, 1e-3);
}

TEST(LightHandles, LightsOutsideThePictureAreMarkedAtItsBorder) {
    const Projection projection(kArea, some_camera());
    const auto handles =
        light_handles(projection, {light_at({40, 1, -1}, RT_LIGHT_POINT), light_at({3, 2, 20}, RT_LIGHT_POINT)});
    for (const LightHandle& handle : handles) {
        EXPECT_EQ(handle.kind, LightHandle::Kind::outside);
        EXPECT_TRUE(kArea.holds(handle.place.x, handle.place.y));
    }
    EXPECT_GT(handles[0].place.x, 700);
    DesiredLight behind = light_at({3, 2, 20}, RT_LIGHT_POINT);
    drag_point_light(behind.values, projection, {200, 200});
    EXPECT_EQ(behind.values.position[2], 20);
}

TEST(LightHandles, EveryDirectionHasAPlaceOnTheDisc) {
    const Projection projection(kArea, some_camera());
    for (int i = 0; i < 200; ++i) {
        // Directions on a Fibonacci spiral over the sphere.
        const float z = 1 - (2 * static_cast<float>(i) + 1) / 200, a = 2.399963f * static_cast<float>(i);
        const glm::vec3 direction(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
        const glm::vec2 place = sun_place(projection, direction);
        EXPECT_TRUE(kArea.holds(place.x, place.y));
        EXPECT_LT(glm::length(sun_direction(projection, place) - direction), 2e-3f);
    }
    DesiredLight sun = light_at({0, 1, 0}, RT_LIGHT_DIRECTIONAL);
    drag_sun(sun.values, projection, {5000, -300});  // outside of the disc: straight behind the eye at most
    float squared = 0;
    for (const float x : sun.values.position) squared += x * x;
    EXPECT_NEAR(squared, 1, 1e-4);
}

TEST(RayLines, EndWhereRaysEnd) {
    RayTree tree;
    RayRecord camera, miss, shadow, dropped;
    camera.origin = {3, 2, 6};
    camera.direction = {0, 0, -1};
    camera.t = 4;
    miss.kind = RayRecord::Kind::mirror;
    miss.origin = {3, 2, 2};
    miss.direction = {0, 1, 0};
    miss.t = std::numeric_limits<float>::infinity();
    shadow.kind = RayRecord::Kind::shadow;
    shadow.origin = {3, 2, 2};
    shadow.direction = {1, 0, 0};
    shadow.t = 2;
    dropped.fate = RayRecord::Fate::too_light;
    tree.rays = {camera, miss, shadow, dropped};
    LineList lines;
    append_ray_lines(tree, Projection(kArea, some_camera()), 30, 1, -1, lines);
    const auto has = [&](const glm::vec3& a, const glm::vec3& b, uint32_t color) {
        for (const Line& line : lines.lines())
            if (line.a == a && glm::length(line.b - b) < 1e-4f && line.color == color) return true;
        return false;
    };
    EXPECT_TRUE(has({3, 2, 6}, {3, 2, 2}, ray_kinds()[0].color));
    EXPECT_TRUE(has({3, 2, 2}, {3, 32, 2}, ray_kinds()[1].color));
    EXPECT_TRUE(has({3, 2, 2}, {5, 2, 2}, ray_kinds()[3].color));
    for (const Line& line : lines.lines())
        for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(line.a[k]) && std::isfinite(line.b[k]));
    const size_t without = lines.size();
    lines.clear();
    append_ray_lines(tree, Projection(kArea, some_camera()), 30, 1, 3, lines);
    EXPECT_GT(lines.size(), without);  // a selected ray is drawn even if it was not traced
}

TEST(SelectionBox, IsAlignedWithTheInstance) {
    Scene scene;
    scene.positions = {0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3};
    scene.triangles = {0, 1, 2, 0, 1, 3};
    scene.triangle_materials = {0, 0};
    scene.meshes.push_back({"m", 0, 4, 0, 2, 2});
    Instance instance;
    instance.world_from_object = {0, -1, 0, 10, 1, 0, 0, 0, 0, 0, 1, 0};  // a quarter turn about z, then 10 along x
    scene.instances.push_back(instance);
    Sphere sphere;
    sphere.center = {5, 5, 5};
    sphere.radius = 2;
    scene.spheres.push_back(sphere);
    Selection selection;
    EXPECT_FALSE(selection_box(scene, selection));
    selection.instance = 0;
    const auto box = selection_box(scene, selection);
    ASSERT_TRUE(box);
    EXPECT_NEAR(glm::length(vec(box->corners()[7]) - glm::vec3(8, 1, 3)), 0, 1e-5);
    selection = {};
    selection.prim = 2;  // after two triangles
    const auto ball = selection_box(scene, selection);
    ASSERT_TRUE(ball);
    EXPECT_EQ(ball->corners()[0][0], 3);
    EXPECT_EQ(ball->corners()[7][2], 7);
    selection.instance = 77;
    selection.prim = -1;
    EXPECT_FALSE(selection_box(scene, selection));
}

TEST(PictureDifference, CountsPixels) {
    std::vector<uint8_t> pixels = {10, 20, 30, 255, 0, 0, 0, 255};
    const ByteImage a{2, 1, pixels};
    EXPECT_EQ(compare_pictures(a, a).largest, 0);
    pixels[5] = 12;
    ByteImage b{2, 1, pixels};
    const PictureDifference difference = compare_pictures(a, b);
    EXPECT_EQ(difference.largest, 12);
    EXPECT_NEAR(difference.share, 0.5, 1e-9);
    EXPECT_NEAR(difference.mean, 2, 1e-9);
    EXPECT_EQ(difference.image.pixels[5], 96);
    b.width = 1;
    EXPECT_EQ(compare_pictures(a, b).share, 1);
}

// Two runs of one structure on a busy machine differ by chance, which must not give a verdict.
TEST(SpeedVerdict, NamesNoFasterSideWithinTheSpread) {
    const std::vector<float> calm = {10, 10.1f, 10.2f, 9.9f, 10, 10.1f, 9.8f, 10, 10.1f, 10};
    const auto scaled = [](std::vector<float> times, float by) {
        for (float& ms : times) ms *= by;
        return times;
    };
    EXPECT_EQ(speed_verdict(calm, scaled(calm, 2)), "2.00\u00d7 faster");
    EXPECT_EQ(speed_verdict(scaled(calm, 2), calm), "");
    EXPECT_EQ(speed_verdict(calm, scaled(calm, 20)), "20\u00d7 faster");
    EXPECT_EQ(speed_verdict(calm, calm), "about the same");
    EXPECT_EQ(speed_verdict(calm, scaled(calm, 1.01f)), "about the same");
    // The medians differ by a factor of 1.23, but the times vary more than that from frame to frame.
    const std::vector<float> busy = {10, 14, 9, 18, 11, 10, 16, 12, 9, 13}, busier = scaled(busy, 1.23f);
    EXPECT_EQ(speed_verdict(busy, busier), "about the same");
    EXPECT_EQ(speed_verdict(busier, busy), "about the same");
    // One delayed frame changes nothing.
    std::vector<float> held_up = calm;
    held_up[3] = 500;
    EXPECT_EQ(speed_verdict(held_up, scaled(calm, 2)), "2.00\u00d7 faster");
    // Too few times for a verdict.
    EXPECT_EQ(speed_verdict({1, 1, 1, 1}, {5, 5, 5, 5}), "");
    EXPECT_EQ(speed_verdict({}, {}), "");
}

}  // namespace
}  // namespace clarity::ui
