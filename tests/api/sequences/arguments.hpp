// arguments.hpp -- arguments of calls: rays in arrays of any steps, structs of older and later headers, watches.
#pragma once
#include <cstddef>
#include <vector>

#include "things.hpp"

namespace sequences {

// A struct as a caller has it whose header is another one: longer, with anything behind the members that are known.
template <class T>
class Struct {
 public:
    Struct() = default;
    Struct(Draw& draw, T value) : bytes_(sizeof(T) + (draw.chance(0.2) ? 8 * draw.below(4) : 0)) {
        value.struct_bytes = static_cast<uint32_t>(bytes_.size());
        std::memcpy(bytes_.as<char>(), &value, sizeof value);
    }
    // With the size of no header.
    void spoil(uint32_t struct_bytes) { get()->struct_bytes = struct_bytes; }
    T* get() const { return bytes_.as<T>(); }

 private:
    Bytes bytes_;
};

// Rays in arrays of their own, which go when the call has ended.
class RayArrays {
 public:
    // Rays to the world and past it.
    RayArrays(Draw& draw, const World& world, double far, size_t count);
    clarity_rays given;
    std::vector<Ray> rays;

 private:
    // Numbers of one array, `width` of each ray, and where it begins and its steps.
    const void* lay_out(Draw& draw, const std::vector<double>& numbers, size_t width, bool one_for_all, int64_t* steps);
    Bytes arrays_[4];
    size_t arrays_made_ = 0;
};
size_t some_count(Draw& draw);

// Positions as numbers of a type. They become what the library makes of them.
Bytes positions_as(bool is_double, std::vector<Point>& positions);

// A watch, or none.
class Watch {
 public:
    enum class Kind { none, looks_on, cancelled, cancels_soon, wrong };
    // may: whether it may be other than good.
    Watch(Draw& draw, bool may);
    const clarity_watch* get() const { return kind == Kind::none ? nullptr : watch_.get(); }
    Kind kind;
    // The call has ended, which had no other mistake. done_at_once: it may be too quick for a cancel.
    void ended(const Step& step, int32_t code, bool done_at_once = false) const;

 private:
    static Kind drawn(Draw& draw, bool may);
    static int32_t tell(void* user, const char* stage, float fraction);
    Bytes cancel_{sizeof(int32_t)};
    std::atomic<int> left_{1 << 30};  // calls until it cancels
    Struct<clarity_watch> watch_;
};

}  // namespace sequences
