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
    kCubic = 0x8,
    kNextValue = 0x100,  // of constant keys
    kTcb = 0x200,        // of cubic keys, as are the next five; without kTcb and kUser their slopes are automatic
    kUser = 0x400,
    kClamp = 0x1000,
    kTimeIndependent = 0x2000,
    kClampProgressive = 0x4000,
    kWeightedRight = 0x1000000,
    kWeightedNextLeft = 0x2000000
};
constexpr double kUsualWeight = 1.0 / 3;

// The rest of a key, which says how the span behind it begins and ends. data: of kUser keys the slope at the key's right side
// and at the left side of the next key, in values a second; of kTcb keys tension, continuity and bias; of automatic keys how
// far the same two sides lean, in percent. The weights say how far the handles reach, as parts of the span.
struct KeyAttributes {
    uint32_t flags = 0;
    double data[3] = {0, 0, 0};
    double weight = kUsualWeight, next_weight = kUsualWeight;
    bool is_cubic() const { return (flags & (kConstant | kCubic)) == kCubic; }
    bool is_tcb() const { return is_cubic() && (flags & kTcb); }
    bool is_automatic() const { return is_cubic() && (flags & (kTcb | kUser)) == 0; }
};

struct Slopes {
    double left = 0, right = 0;
};

// A key and the lines to its neighbours. before, behind: their lengths in seconds, 0 where there is none.
struct Neighbours {
    Neighbours(const Curve& c, size_t i) {
        if (i > 0) before = c.times[i] - c.times[i - 1], down = c.values[i] - c.values[i - 1];
        if (i + 1 < c.times.size()) behind = c.times[i + 1] - c.times[i], up = c.values[i + 1] - c.values[i];
        if (before > 0) slopes.left = down / before;
        if (behind > 0) slopes.right = up / behind;
    }
    bool is_edge() const { return !(before > 0 && behind > 0); }
    double before = 0, behind = 0, down = 0, up = 0;
    Slopes slopes;
};

// D. Kochanek, R. Bartels, "Interpolating splines with local tension, continuity, and bias control", SIGGRAPH 1984, with slopes
// in place of differences, because keys are not evenly spaced. A first or last key has one line, which counts fully. Measured
// from motionbuilder_tangent_tcb_7700_ascii of ufbx.
Slopes tcb_slopes(const Neighbours& n, const double* tcb) {
    const double factor = (n.is_edge() ? 1.0 : 0.5) * (1 - tcb[0]);
    const double sharp = 1 - tcb[1], smooth = 1 + tcb[1], from_left = factor * (1 + tcb[2]), from_right = factor * (1 - tcb[2]);
    return {from_left * sharp * n.slopes.left + from_right * smooth * n.slopes.right,
            from_left * smooth * n.slopes.left + from_right * sharp * n.slopes.right};
}

// A lean of more than 500 percent adds to the slope, whatever the keys are. Measured by ufbx.
double added_by_lean(double lean, double sign) {
    const double beyond = std::abs(lean) / 100 - 5;
    return beyond > 0 ? beyond * beyond * 40 * (sign > 0 ? 1 : -1) : 0;
}

// One side of an automatic key: the slope from the previous key to the next one. If the key is not independent of time, half
// of that and half of a parabola's. At the first and last key, that of the only line, or 0 if the key is clamped progressively.
// Clamped keys are flat where a neighbour has the same value; those clamped progressively also at peaks and valleys, and their
// handles stay between the values of the neighbours. Measured from motionbuilder_tangent_auto_7700_ascii,
// maya_extrapolate_cube_7700_binary, maya_game_sausage_7500_binary_combined; leans and clamps by ufbx.
double automatic_slope(const Neighbours& n, uint32_t flags, double lean, double weight_before, double weight_behind) {
    if (n.is_edge()) {
        const bool is_flat = (n.before > 0 ? n.down : n.up) == 0;
        if ((flags & kClampProgressive) || (is_flat && (flags & kClamp)) || !(n.before > 0 || n.behind > 0)) return 0;
        const double slope = n.before > 0 ? n.slopes.left : n.slopes.right;
        return flags & kTimeIndependent ? slope : slope + added_by_lean(lean, lean);
    }
    if ((flags & kClamp) && (n.down == 0 || n.up == 0)) return 0;
    double slope = (n.down + n.up) / (n.before + n.behind);
    if ((flags & kTimeIndependent) == 0) {
        const double share = n.before / (n.before + n.behind), weight = std::abs(lean) / 100;
        slope = 0.5 * (slope + n.slopes.left * (1 - share) + n.slopes.right * share);
        if (weight > 1e-4) {
            const double wanted = lean > 0 ? n.slopes.right : n.slopes.left, change = wanted - slope;
            slope += weight * change + added_by_lean(lean, std::abs(change) > 1e-5 ? change : lean);
        }
    }
    if ((flags & kClampProgressive) == 0) return slope;
    const double sign = slope < 0 ? -1 : 1;
    const auto limit = [&](double step, double reach) { return reach > 0 ? std::max(sign * step / reach, 0.0) : 0; };
    return sign * std::min({std::abs(slope), limit(n.down, weight_before * n.before), limit(n.up, weight_behind * n.behind)});
}

Slopes slopes_of_key(const Curve& c, const std::vector<KeyAttributes>& keys, size_t i) {
    const KeyAttributes& key = keys[i];
    const KeyAttributes none, &last = i > 0 ? keys[i - 1] : none;
    // A TCB key says nothing about the next one.
    Slopes out = {last.is_cubic() && !last.is_tcb() ? last.data[1] : 0, key.data[0]};
    const Neighbours n(c, i);
    if (key.is_tcb()) out = tcb_slopes(n, key.data);
    if (!key.is_automatic()) return out;
    const auto slope = [&](double lean) { return automatic_slope(n, key.flags, lean, last.next_weight, key.weight); };
    const double lean_right = out.right, lean_left = -out.left;
    if (n.is_edge()) {
        out.left = out.right = slope(n.before > 0 ? lean_left : lean_right);
    } else {
        out.right = slope(lean_right);
        out.left = std::abs(lean_right - lean_left) <= 1e-4 ? out.right : slope(lean_left);
    }
    return out;
}

void add_handles(const std::vector<KeyAttributes>& keys, Curve& c) {
    const size_t count = c.times.size();
    bool has_cubic = false;
    for (const KeyAttributes& key : keys) {
        c.spans.push_back(key.flags & kConstant ? (key.flags & kNextValue ? RT_SPAN_STEP_NEXT : RT_SPAN_STEP)
                          : key.is_cubic()      ? RT_SPAN_CUBIC
                                                : RT_SPAN_LINEAR);
        has_cubic = has_cubic || key.is_cubic();
    }
    if (!has_cubic) return;
    c.handles.assign(4 * count, 0);
    for (size_t i = 0; i < count; ++i) {
        const Slopes slopes = slopes_of_key(c, keys, i);
        const double reach_left = i > 0 ? keys[i - 1].next_weight * (c.times[i] - c.times[i - 1]) : 0;
        const double reach_right = i + 1 < count ? keys[i].weight * (c.times[i + 1] - c.times[i]) : 0;
        c.handles[4 * i] = reach_left;
        c.handles[4 * i + 1] = reach_left * slopes.left;
        c.handles[4 * i + 2] = reach_right;
        c.handles[4 * i + 3] = reach_right * slopes.right;
    }
}

// The floats of KeyAttrDataFloat. From version 7.2 on, ASCII files write the bits of each as a whole number. Measured from
// maya_anim_interpolation_7700_ascii, and maya_auto_clamp_7100_ascii of ufbx. A number with a point is one.
std::vector<float> attribute_floats(const Document& document, const Node& curve) {
    const Node* node = document.child(&curve, "KeyAttrDataFloat");
    if (!node || document.is_binary() || document.version() < 7200) return document.numbers<float>(node);
    const Node* inner = document.child(node, "a");
    std::vector<float> out;
    Values values(document, inner ? *inner : *node);
    for (Value v; values.next(v);) {
        if (!v.is_number()) continue;
        out.push_back(static_cast<float>(v.number));
        const uint32_t bits = static_cast<uint32_t>(v.whole);
        if (v.kind == Value::integer) std::memcpy(&out.back(), &bits, 4);
    }
    return out;
}

// One set of attributes: two or three numbers, and the weights, which are 1/9999 in 16 bits each, the right one in the lower
// half of the third number. Source: FBX SDK help, "FbxAnimCurveDef"; measured from maya_anim_interpolation_7700_ascii.
KeyAttributes attributes_of_set(uint32_t flags, const float* set) {
    KeyAttributes key;
    key.flags = flags;
    if (!set) return key;
    for (int k = 0; k < (key.is_tcb() ? 3 : 2); ++k) key.data[k] = set[k];
    if (!key.is_cubic() || key.is_tcb()) return key;
    uint32_t bits;
    std::memcpy(&bits, set + 2, 4);
    if (flags & kWeightedRight) key.weight = (bits & 0xFFFF) / 9999.0;
    if (flags & kWeightedNextLeft) key.next_weight = (bits >> 16) / 9999.0;
    return key;
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
    if (repeats == 0 && mode != RT_OUTSIDE_SLOPE) mode = RT_OUTSIDE_HOLD;
    count = repeats > 0 ? static_cast<rt_u32>(std::min<int64_t>(repeats, 0xFFFFFFFF)) : 0;
}

void read_outside(const Document& document, const Node& curve, Curve& c) {
    read_outside(document, document.child(&curve, "Pre-Extrapolation"), c.before, c.before_count);
    read_outside(document, document.child(&curve, "Post-Extrapolation"), c.after, c.after_count);
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

// 46186158000, or 141120000 from version 8 on. If FBXHeaderVersion is 1004 or more, TCDefinition says which: 127 is the first.
// Source: README of the shared scenes; measured from synthetic_tcdefinition_127_7700_ascii.
double ticks_of_second(const Document& document) {
    const Node* header = document.child(&document.root(), "FBXHeaderExtension");
    const Node* definition = document.child(document.child(header, "OtherFlags"), "TCDefinition");
    const bool is_defined = definition && document.integer(document.child(header, "FBXHeaderVersion"), 0, 0) >= 1004;
    const bool is_new = is_defined ? document.integer(definition, 0, 127) != 127 : document.version() >= 8000;
    return is_new ? 141120000.0 : 46186158000.0;
}

// KeyAttrRefCount says how many keys share each set of attributes. A set has flags and four floats. Measured from
// maya_anim_interpolation_7700_ascii and maya_extrapolate_cube_7700_binary.
Curve read_curve(const Document& document, const Node& node, double ticks) {
    Curve c;
    c.values = document.numbers<double>(&node, "KeyValueFloat");
    const std::vector<int64_t> times = document.numbers<int64_t>(&node, "KeyTime");
    const size_t count = std::min(times.size(), c.values.size());
    c.values.resize(count);
    for (size_t i = 0; i < count; ++i) c.times.push_back(static_cast<double>(times[i]) / ticks);
    const std::vector<int32_t> flags = document.numbers<int32_t>(&node, "KeyAttrFlags");
    const std::vector<int32_t> repeats = document.numbers<int32_t>(&node, "KeyAttrRefCount");
    const std::vector<float> data = attribute_floats(document, node);
    std::vector<KeyAttributes> keys;
    for (size_t set = 0; set < flags.size() && keys.size() < count; ++set) {
        const float* floats = 4 * set + 3 < data.size() ? &data[4 * set] : nullptr;
        const size_t sharing = set < repeats.size() && repeats[set] > 0 ? static_cast<size_t>(repeats[set]) : 1;
        keys.insert(keys.end(), std::min(sharing, count - keys.size()),
                    attributes_of_set(static_cast<uint32_t>(flags[set]), floats));
    }
    KeyAttributes linear;
    linear.flags = kLinear;
    keys.resize(count, linear);
    add_handles(keys, c);
    read_outside(document, node, c);
    check(document, node, c);
    return c;
}

namespace {

// How a cubic key of a take goes on behind its letter: numbers, and letters that say which weights follow.
struct CubicForm {
    char letter;
    uint32_t flags;
    int numbers;
    int weights, weights_before_4005;  // before KeyVer 4005
};
constexpr CubicForm kCubicForms[] = {
    {'s', kUser, 2, 1, 1},
    {'b', kUser, 2, 1, 1},
    {'a', kClampProgressive | kTimeIndependent, 0, 1, 0},
    {'d', kClampProgressive | kTimeIndependent, 1, 1, 1},
    {'p', kClampProgressive | kTimeIndependent, 2, 2, 1},
    {'q', kClampProgressive | kTimeIndependent, 2, 2, 1},
    {'t', kTcb, 3, 0, 0},
};

class TakeKeys {
 public:
    TakeKeys(const Document& document, const Node& channel, const Node& key)
        : document_(document), key_(key), values_(document, key) {
        const int64_t stated = document.integer(document.child(&channel, "KeyVer"), 0, 0);
        const int version = document.version();
        key_version_ = stated > 0 ? stated : version < 5000 ? 4003 : version < 6000 ? 4004 : 4005;
    }
    void read(double ticks, Curve& c, std::vector<KeyAttributes>& keys) {
        for (Value v; values_.next(v);) {
            if (!v.is_number()) fail(c, "has no time; expected a number");
            c.times.push_back(v.number / ticks);
            c.values.push_back(number());
            keys.push_back(attributes(c));
        }
    }

 private:
    double number() { return values_.next(value_) ? value_.number : 0; }
    // In binary files letters are whole numbers.
    char letter() {
        if (!values_.next(value_)) return '\0';
        return value_.text.empty() ? static_cast<char>(value_.whole) : value_.text[0];
    }
    [[noreturn]] void fail(const Curve& c, const std::string& what) {
        document_.fail(key_, "key " + std::to_string(c.times.size()) + " " + what);
    }
    KeyAttributes attributes(const Curve& c) {
        KeyAttributes out;
        const char kind = letter();
        if (kind == 'C') {
            out.flags = kConstant | (key_version_ >= 4004 && letter() == 'n' ? kNextValue : 0u);
        } else if (kind == 'L') {
            out.flags = kLinear;
        } else if (kind == 'U') {
            add_cubic(c, out);
        } else {
            fail(c, "is neither constant, linear nor cubic; expected C, L or U");
        }
        return out;
    }
    void add_cubic(const Curve& c, KeyAttributes& out) {
        const char found = letter();
        const auto* const form =
            std::find_if(std::begin(kCubicForms), std::end(kCubicForms), [&](const CubicForm& f) { return f.letter == found; });
        if (form == std::end(kCubicForms)) fail(c, "has tangents of an unknown kind; expected one of the letters sbadpqt");
        out.flags = kCubic | form->flags;
        for (int i = 0; i < form->numbers; ++i) {
            const double x = number();
            if (form->flags & (kUser | kTcb)) out.data[i] = x;
        }
        int weights = key_version_ >= 4005 ? form->weights : form->weights_before_4005;
        if (form->flags == kUser && key_version_ == 4003) weights = 0;
        for (; weights > 0; --weights) {
            const char which = letter();
            if (which == 'r' || which == 'a') out.weight = number();
            if (which == 'l' || which == 'a') out.next_weight = number();
        }
    }
    const Document& document_;
    const Node& key_;
    Values values_;
    Value value_;
    int64_t key_version_;
};

}  // namespace

// Before version 7: `Key: time, value, letter, ...`. C: constant, with s (this value) or n (the next one). L: linear. U: cubic,
// with one of kCubicForms. The weights' letters: n none, r the right one, l the next left one, a both. Measured from
// max2009_cube_anim_5800_ascii, max_transformed_skin_6100_ascii, maya_game_sausage_6100_ascii_combined and
// blender_279_sausage_6100_ascii; p, q, d and what KeyVer changes: by ufbx, which takes them for automatic.
Curve read_take_curve(const Document& document, const Node& channel, double ticks) {
    const Node* key = document.child(&channel, "Key");
    Curve c;
    std::vector<KeyAttributes> keys;
    if (key) TakeKeys(document, channel, *key).read(ticks, c, keys);
    if (c.times.empty()) {
        const Node* rest = document.child(&channel, "Default");
        return rest ? Curve::constant(document.number(rest, 0, 0)) : c;
    }
    add_handles(keys, c);
    read_outside(document, channel, c);
    check(document, channel, c);
    return c;
}

}  // namespace fbx_import
