#include "curves.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace fbx_import {
namespace {

// Flags of a key. Source: FBX SDK help, "FbxAnimCurveDef".
enum : uint32_t {
    kConstant = 0x2,
    kLinear = 0x4,
    kNextValue = 0x100,
    kAuto = 0x100,
    kClampProgressive = 0x4000,
    kClamp = 0x1000,
    kWeightedRight = 0x1000000,
    kWeightedNextLeft = 0x2000000
};
constexpr double kUsualWeight = 1.0 / 3;

// The rest of a key. slope: at its right side; next_slope: at the left side of the next key; both are values a second. The
// weights say how far the handles reach, as parts of the span between the two keys.
struct Tangents {
    uint32_t flags = 0;
    double slope = 0, next_slope = 0, weight = kUsualWeight, next_weight = kUsualWeight;
};

// The slope of an automatic key: that of the line from the previous key to the next one; 0 at the first and last key. Clamped
// keys are flat at peaks and valleys, and their handles stay between the values of the neighbours. Measured from
// motionbuilder_tangent_auto_7700_ascii, maya_extrapolate_cube_7700_binary and maya_game_sausage_7500_binary_combined.
double auto_slope(const Curve& c, size_t i, uint32_t flags, double weight_before, double weight_behind) {
    if (i == 0 || i + 1 == c.times.size()) return 0;
    const double before = c.times[i] - c.times[i - 1], behind = c.times[i + 1] - c.times[i];
    const double down = c.values[i] - c.values[i - 1], up = c.values[i + 1] - c.values[i];
    if (!(before > 0 && behind > 0)) return 0;
    double slope = (down + up) / (before + behind);
    if ((flags & (kClamp | kClampProgressive)) == 0) return slope;
    if (down * up <= 0) return 0;
    const double sign = slope < 0 ? -1 : 1;
    slope = std::min({std::abs(slope), std::abs(down) / (before * std::max(weight_before, 1e-6)),
                      std::abs(up) / (behind * std::max(weight_behind, 1e-6))});
    return sign * slope;
}

void add_handles(const std::vector<Tangents>& tangents, Curve& c) {
    const size_t count = c.times.size();
    bool has_cubic = false;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t flags = tangents[i].flags;
        c.spans.push_back(flags & kConstant ? (flags & kNextValue ? RT_SPAN_STEP_NEXT : RT_SPAN_STEP)
                          : flags & kLinear ? RT_SPAN_LINEAR
                                            : RT_SPAN_CUBIC);
        has_cubic = has_cubic || c.spans.back() == RT_SPAN_CUBIC;
    }
    if (!has_cubic) return;
    c.handles.assign(4 * count, 0);
    for (size_t i = 0; i + 1 < count; ++i) {
        const Tangents& t = tangents[i];
        const Tangents& next = tangents[i + 1];
        const double span = c.times[i + 1] - c.times[i];
        double slope = t.slope, next_slope = t.next_slope;
        if (t.flags & kAuto) slope = auto_slope(c, i, t.flags, i > 0 ? tangents[i - 1].next_weight : t.weight, t.weight);
        if (next.flags & kAuto) next_slope = auto_slope(c, i + 1, next.flags, t.next_weight, next.weight);
        c.handles[4 * i + 2] = t.weight * span;
        c.handles[4 * i + 3] = t.weight * span * slope;
        c.handles[4 * i + 4] = t.next_weight * span;
        c.handles[4 * i + 5] = t.next_weight * span * next_slope;
    }
}

// Weights are 1/9999 in 16 bits, the right one in the lower half. Source: FBX SDK help, "FbxAnimCurveDef"; measured from
// maya_anim_interpolation_7700_ascii, which writes both as one whole number, where binary files have the bits of a float.
uint32_t weight_bits(bool is_binary, double number) {
    if (!is_binary) return number >= 0 && number < 4294967296.0 ? static_cast<uint32_t>(number) : 0;
    const float as_float = static_cast<float>(number);
    uint32_t bits;
    std::memcpy(&bits, &as_float, 4);
    return bits;
}

// Type: C hold, R repeat, M mirror, K keep the slope, A repeat relative to the last value. Repetition -1: without end. Measured
// from maya_extrapolate_cube_7700_binary; the letters: FBX SDK help, "FbxAnimCurveBase::EExtrapolationType".
void read_outside(const Document& document, const Node* node, rt_u32& mode, rt_u32& count) {
    if (!node) return;
    const Node* type = document.child(node, "Type");
    const std::string_view word = document.text(type, 0);
    const int64_t letter = word.empty() ? document.integer(type, 0, 'C') : word[0];
    mode = letter == 'R'   ? RT_OUTSIDE_REPEAT
           : letter == 'M' ? RT_OUTSIDE_MIRROR
           : letter == 'K' ? RT_OUTSIDE_SLOPE
           : letter == 'A' ? RT_OUTSIDE_REPEAT_RELATIVE
                           : RT_OUTSIDE_HOLD;
    const int64_t repeats = document.integer(document.child(node, "Repetition"), 0, -1);
    if (repeats == 0) mode = RT_OUTSIDE_HOLD;
    count = repeats > 0 ? static_cast<rt_u32>(std::min<int64_t>(repeats, 0xFFFFFFFF)) : 0;
}

void check(const Document& document, const Node& node, const Curve& c) {
    if (!c.is_sound()) document.fail(node, "the keys of a curve are not finite, or not in the order of their times");
}

}  // namespace

// Frames a second of the time modes from 1 on; 14 has a number of its own. Source: FBX SDK help, "FbxTime::EMode".
static constexpr double kRates[] = {120, 100, 60,   50,           48, 30, 30, 29.97002997, 29.97002997,
                                    25,  24,  1000, 23.976023976, 0,  96, 72, 59.94005994, 119.88011988};

double frames_of_second(const Document& document, const Objects& objects) {
    const Node* root = &document.root();
    const Node* version5 = document.child(root, "Version5");
    // Up to version 5.8: `Settings: FrameRate: "30"` (measured from max2009_cube_anim_5800_ascii).
    const Node* oldest = document.child(document.child(version5 ? version5 : root, "Settings"), "FrameRate");
    const Properties p(document, objects.settings());
    const int64_t mode = p.whole("TimeMode", -1);
    if (mode == 14) return std::clamp(p.number("CustomFrameRate", 0), 0.0, 1e6);
    if (mode >= 1 && mode <= 18) return kRates[mode - 1];
    if (mode == 0) return 30;
    const double stated = std::strtod(std::string(document.text(oldest, 0)).c_str(), nullptr);
    return stated > 0 && stated < 1e6 ? stated : 0;
}

// 46186158000, or 141120000 if FBXHeaderVersion is 1004 or more and TCDefinition is there and not 127. Source: README of the
// shared scenes; measured from synthetic_tcdefinition_127_7700_ascii.
double ticks_of_second(const Document& document) {
    const Node* header = document.child(&document.root(), "FBXHeaderExtension");
    const Node* definition = document.child(document.child(header, "OtherFlags"), "TCDefinition");
    const bool is_new = document.integer(document.child(header, "FBXHeaderVersion"), 0, 0) >= 1004 &&
                        (definition ? document.integer(definition, 0, 127) != 127 : document.version() >= 8000);
    return is_new ? 141120000.0 : 46186158000.0;
}

// KeyAttrRefCount says how many keys share each set of attributes. A set has flags and four floats: two slopes, the weights in
// one float, and one that is not used. Measured from maya_anim_interpolation_7700_ascii and maya_extrapolate_cube_7700_binary.
Curve read_curve(const Document& document, const Node& node, double ticks) {
    Curve c;
    c.values = document.numbers<double>(&node, "KeyValueFloat");
    const std::vector<int64_t> times = document.numbers<int64_t>(&node, "KeyTime");
    const size_t count = std::min(times.size(), c.values.size());
    c.values.resize(count);
    for (size_t i = 0; i < count; ++i) c.times.push_back(static_cast<double>(times[i]) / ticks);
    const std::vector<int32_t> flags = document.numbers<int32_t>(&node, "KeyAttrFlags");
    const std::vector<int32_t> repeats = document.numbers<int32_t>(&node, "KeyAttrRefCount");
    const std::vector<double> data = document.numbers<double>(&node, "KeyAttrDataFloat");
    std::vector<Tangents> tangents;
    for (size_t set = 0; set < flags.size() && tangents.size() < count; ++set) {
        Tangents t;
        t.flags = static_cast<uint32_t>(flags[set]);
        if (4 * set + 3 < data.size()) {
            const uint32_t bits = weight_bits(document.is_binary(), data[4 * set + 2]);
            t.slope = data[4 * set];
            t.next_slope = data[4 * set + 1];
            if (t.flags & kWeightedRight) t.weight = (bits & 0xFFFF) / 9999.0;
            if (t.flags & kWeightedNextLeft) t.next_weight = (bits >> 16) / 9999.0;
        }
        const size_t keys = set < repeats.size() && repeats[set] > 0 ? static_cast<size_t>(repeats[set]) : 1;
        tangents.insert(tangents.end(), std::min(keys, count - tangents.size()), t);
    }
    tangents.resize(count, Tangents{kLinear});
    add_handles(tangents, c);
    read_outside(document, document.child(&node, "Pre-Extrapolation"), c.before, c.before_count);
    read_outside(document, document.child(&node, "Post-Extrapolation"), c.after, c.after_count);
    check(document, node, c);
    return c;
}

// Before version 7: `Key: time, value, letter, ...`. C: constant, with s (this value) or n (the next one). L: linear. U, or any
// other: cubic, with s or b, the slope behind and the slope before the next key; or with a: automatic, no slopes. A cubic key
// then has a letter for the weights: n none, r the right one, l the next left one, a both. Measured from
// max2009_cube_anim_5800_ascii, max_transformed_skin_6100_ascii, maya_game_sausage_6100_ascii_combined and
// blender_279_sausage_6100_ascii.
Curve read_take_curve(const Document& document, const Node& channel, double ticks) {
    const Node* key = document.child(&channel, "Key");
    Curve c;
    std::vector<Tangents> tangents;
    if (key) {
        Values values(document, *key);
        Value v;
        const auto number = [&] { return values.next(v) ? v.number : 0; };
        // In binary files letters are whole numbers.
        const auto letter = [&] { return !values.next(v) ? '\0' : v.text.empty() ? static_cast<char>(v.whole) : v.text[0]; };
        while (values.next(v)) {
            if (!v.is_number()) {
                document.fail(*key, "key " + std::to_string(c.times.size()) + " has no time; expected a number");
            }
            c.times.push_back(v.number / ticks);
            c.values.push_back(number());
            Tangents t;
            const char kind = letter();
            if (kind == 'C') {
                t.flags = kConstant | (letter() == 'n' ? kNextValue : 0u);
            } else if (kind == 'L') {
                t.flags = kLinear;
            } else {
                if (letter() == 'a') {
                    t.flags = kAuto;
                } else {
                    t.slope = number();
                    t.next_slope = number();
                }
                const char weights = letter();
                if (weights == 'r' || weights == 'a') t.weight = number();
                if (weights == 'l' || weights == 'a') t.next_weight = number();
            }
            tangents.push_back(t);
        }
    }
    if (c.times.empty()) {
        const Node* rest = document.child(&channel, "Default");
        return rest ? Curve::constant(document.number(rest, 0, 0)) : c;
    }
    add_handles(tangents, c);
    check(document, channel, c);
    return c;
}

}  // namespace fbx_import
