#include "sky.hpp"

#include <algorithm>

#include "diagnostics.hpp"

namespace scene_format {
namespace {

constexpr float kMostRadiance = 1e12f, kMostTurn = 1e6f;

}  // namespace

void read_sky(Statement& s, Document& document, Diagnostics&) {
    enum { kRotate, kStrength, kVisible, kZenith, kHorizon, kGround };
    if (document.sky.position.line != 0)
        throw StatementError{s.position(), "statement `sky` for the second time; the first is in line " +
                                               std::to_string(document.sky.position.line)};
    Sky sky;
    sky.position = s.position();
    rt_sky_desc& values = sky.values;
    values.strength = 1;
    std::fill_n(values.color, 3, 1.f);
    const std::string first = s.path("the path of a picture, `constant` or `gradient`");
    const bool constant = first == "constant", gradient = first == "gradient";
    values.kind = constant ? RT_SKY_CONSTANT : gradient ? RT_SKY_GRADIENT : RT_SKY_PICTURE;
    if (values.kind == RT_SKY_PICTURE) sky.path = first;
    std::vector<Key> keys = {{"rotate"}, {"strength"}, {"visible"}};
    if (gradient) keys.insert(keys.end(), {{"zenith"}, {"horizon"}, {"ground"}});
    s.expect_keys(keys);
    const auto color = [&](const char* what, float(&to)[3]) {
        const Vec3 read = s.color(what, kMostRadiance);
        std::copy(read.begin(), read.end(), to);
    };
    if (constant) color("the sky's radiance (r g b)", values.color);
    while (!s.done()) {
        switch (s.key()) {
            case kRotate:
                values.rotate_deg = s.number_between("`rotate` (degrees about +Y)", -kMostTurn, kMostTurn);
                break;
            case kStrength:
                values.strength = s.number_between("`strength`", 0, kMostRadiance);
                break;
            case kVisible:
                values.hidden = s.choice("`visible`", {"true", "false"}) == 0 ? 0 : 1;
                break;
            case kZenith:
                color("`zenith` (r g b)", values.color);
                break;
            case kHorizon:
                color("`horizon` (r g b)", values.horizon);
                break;
            case kGround:
                color("`ground` (r g b)", values.ground);
                break;
        }
    }
    document.sky = sky;
}

}  // namespace scene_format
