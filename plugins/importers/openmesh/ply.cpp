// ply.cpp -- reads PLY: text, and binary of both byte orders. Elements and properties may have any order; what is not needed is
// passed over. Source: G. Turk, "The PLY Polygon File Format" (1994); triangle strips: the Stanford 3D Scanning Repository.
#include <algorithm>
#include <stdexcept>

#include "../common/numbers.hpp"
#include "ply_header.hpp"
#include "readers.hpp"
#include "text.hpp"

namespace openmesh_import {
namespace {

using ply::Element;
using ply::Header;
using ply::Kind;
using ply::Number;
using ply::Property;
using ply::Role;

// Thrown where the data end.
struct End {};

// Where reading is: for messages.
struct Place {
    const Element* element = nullptr;
    unsigned long long item = 0;
};

// The values of a text. An element may go on in the next line. What stands behind its last value on a line is dropped, because
// MeshLab writes such lines.
class AsciiValues {
 public:
    AsciiValues(const Header& header, const Place& place) : header_(header), place_(place), lines_(header.body) {}

    double number(const Property&) {
        const std::string_view text = word();
        double value = NAN;
        if (!parse_float(text, value) && !is_odd_number(text))
            throw std::runtime_error(where() + quoted(text) + " instead of a number");
        return value;
    }
    int64_t index(const Property&) {
        const std::string_view text = word();
        long long value = 0;
        if (!parse_integer(text, value)) {
            // An integer of any length is a number out of range.
            if (text.empty() || text.find_first_not_of("0123456789", text[0] == '-' ? 1 : 0) != text.npos)
                throw std::runtime_error(where() + quoted(text) + " instead of an integer");
            value = INT64_MAX;
        }
        return value;
    }
    uint64_t length(const Property& property) {
        const std::string_view text = word();
        long long count = 0;
        if (!parse_integer(text, count) || count < 0)
            throw std::runtime_error(where() + quoted(text) + " instead of the length of a list");
        if (property.role != Role::indices && static_cast<unsigned long long>(count) > header_.body.size() / 2)
            throw std::runtime_error(where() + "a list of " + quoted(text) + " values, more than the file can hold");
        return static_cast<uint64_t>(count);
    }
    void skip(const Property& property, uint64_t count) {
        for (; count > 0; --count) number(property);
    }
    void end_element() { line_ = {}; }
    float fraction() const { return lines_.fraction(); }
    std::string where() const {
        const std::string line = "line " + std::to_string(header_.lines + lines_.number()) + ": ";
        if (!place_.element) return line;
        return line + quoted(place_.element->name) + " " + std::to_string(place_.item + 1) + " of " +
               std::to_string(place_.element->count) + ": ";
    }

 private:
    std::string_view word() {
        for (;;) {
            const std::string_view found = next_word(line_);
            if (!found.empty()) return found;
            if (!lines_.next(line_)) throw End();
        }
    }
    const Header& header_;
    const Place& place_;
    Lines lines_;
    std::string_view line_;  // what is left of it
};

template <bool BigEndian>
class BinaryValues {
 public:
    BinaryValues(const Header& header, const Place& place, size_t file_bytes)
        : place_(place),
          at_(header.body.data()),
          first_(at_),
          end_(at_ + header.body.size()),
          body_(file_bytes - header.body.size()) {}

    double number(const Property& property) { return value<double>(*property.type); }
    int64_t index(const Property& property) { return value<int64_t>(*property.type); }
    uint64_t length(const Property& property) {
        // The sign of the length's type does not matter.
        constexpr uint64_t masks[5] = {0, 0xFF, 0xFFFF, 0, 0xFFFFFFFF};
        const uint64_t count = static_cast<uint64_t>(value<int64_t>(*property.count_type)) & masks[property.count_type->bytes];
        if (count * static_cast<unsigned>(property.type->bytes) <= left()) return count;
        if (property.role == Role::indices) throw End();
        throw std::runtime_error(position() + quoted(place_.element->name) + " " + std::to_string(place_.item + 1) +
                                 ": a list of " + std::to_string(count) + " values, but only " + std::to_string(left()) +
                                 " bytes follow");
    }
    void skip(const Property& property, uint64_t count) { take(count * static_cast<unsigned>(property.type->bytes)); }
    void end_element() {}
    float fraction() const { return static_cast<float>(at_ - first_) / static_cast<float>(end_ - first_); }
    std::string where() const { return position(); }

 private:
    std::string position() const { return "byte " + std::to_string(body_ + static_cast<size_t>(at_ - first_)) + ": "; }
    uint64_t left() const { return static_cast<uint64_t>(end_ - at_); }
    const char* take(uint64_t bytes) {
        if (bytes > left()) throw End();
        const char* const from = at_;
        at_ += bytes;
        return from;
    }
    template <class T, class Stored>
    T stored() {
        return static_cast<T>(importers::load<Stored>(take(sizeof(Stored)), BigEndian));
    }
    template <class T>
    T value(const ply::Type& type) {
        switch (type.number) {
            case Number::int8:
                return stored<T, int8_t>();
            case Number::uint8:
                return stored<T, uint8_t>();
            case Number::int16:
                return stored<T, int16_t>();
            case Number::uint16:
                return stored<T, uint16_t>();
            case Number::int32:
                return stored<T, int32_t>();
            case Number::uint32:
                return stored<T, uint32_t>();
            case Number::float32:
                return static_cast<T>(stored<float, float>());
            default:
                return importers::nearest<T>(stored<double, double>());
        }
    }
    const Place& place_;
    const char *at_, *first_, *end_;
    size_t body_;  // where it begins in the file
};

// Reads the elements in the order of the file, up to the last that is needed.
template <class Values>
class ElementReader {
 public:
    template <class... More>
    ElementReader(const Source& source, const Header& header, FlatMesh& mesh, const More&... more)
        : source_(source), header_(header), mesh_(mesh), values_(header, place_, more...) {}

    void read() {
        size_t needed = header_.elements.size();
        while (header_.elements[needed - 1].kind == Kind::other) --needed;
        try {
            for (size_t i = 0; i < needed; ++i) read(header_.elements[i]);
        } catch (const End&) {
            const Element *vertices = header_.find(Kind::vertices), *faces = header_.find(Kind::faces);
            if (!faces) faces = header_.find(Kind::strips);
            const auto part = [&](const Element& e) {
                return std::to_string(done_[size_t(e.kind)]) + " of " + std::to_string(e.count);
            };
            std::string text = values_.where() + "ends after " + part(*vertices) + " vertices";
            if (faces) text += " and " + part(*faces) + (faces->kind == Kind::faces ? " faces" : " strips");
            throw std::runtime_error(text + ": it is cut off or damaged");
        }
    }

 private:
    void read(const Element& element) {
        if (element.properties.empty()) return;
        place_ = {&element, 0};
        unsigned long long& done = done_[size_t(element.kind)];
        for (done = 0; done < element.count; place_.item = ++done) {
            if (element.kind == Kind::vertices) {
                vertex(element);
            } else if (element.kind == Kind::other) {
                for (const Property& p : element.properties) pass_over(p);
            } else {
                face(element);
            }
            values_.end_element();
            steps_.step([&] { return values_.fraction(); });
        }
        place_ = {};
    }
    void pass_over(const Property& p) {
        // Not in one expression: the length stands before the values.
        const uint64_t count = p.is_list() ? values_.length(p) : 1;
        values_.skip(p, count);
    }
    void vertex(const Element& element) {
        double at[3] = {0, 0, 0};
        float numbers[12] = {};  // from Role::x to Role::alpha
        numbers[11] = 1;
        bool has_normal = false, has_uv = false, has_blue = false;
        for (const Property& p : element.properties) {
            if (p.role < Role::x || p.role > Role::alpha) {
                pass_over(p);
                continue;
            }
            const double number = values_.number(p);
            if (p.role <= Role::z) at[int(p.role) - int(Role::x)] = number;
            numbers[int(p.role) - int(Role::x)] = p.role < Role::red ? static_cast<float>(number) : channel(p, number);
            has_blue = has_blue || p.role == Role::blue;
            has_normal = has_normal || p.role == Role::nz;
            has_uv = has_uv || p.role == Role::v;
        }
        mesh_.add_vertex(at[0], at[1], at[2]);
        // A file with only some of nx, ny and nz has no normals.
        if (has_normal && element.has(Role::nx) && element.has(Role::ny))
            mesh_.normals.insert(mesh_.normals.end(), numbers + 3, numbers + 6);
        if (has_uv && element.has(Role::u)) mesh_.uvs.insert(mesh_.uvs.end(), numbers + 6, numbers + 8);
        if (has_blue && element.has(Role::red) && element.has(Role::green))
            mesh_.colors.insert(mesh_.colors.end(), numbers + 8, numbers + 12);
    }
    // Integers are shares of their type's largest value. Except for alpha they are sRGB, as the pictures are that such files
    // come from, and as Blender 3.6 and three.js read them; the format itself does not say. Floating-point numbers are linear.
    static float channel(const Property& p, double number) {
        if (p.type->is_float()) return static_cast<float>(number);
        const double most = std::ldexp(1.0, 8 * p.type->bytes - (p.type->is_signed() ? 1 : 0)) - 1;
        return p.role == Role::alpha ? static_cast<float>(number / most) : importers::linear_of_srgb(number / most);
    }
    // A face, or a strip of triangles.
    void face(const Element& element) {
        texcoords_.clear();
        size_t corners = 0;
        bool has_texcoords = false;
        for (const Property& p : element.properties) {
            if (p.role == Role::indices && element.kind == Kind::strips) {
                strip(p);
            } else if (p.role == Role::indices) {
                corners = values_.length(p);
                for (size_t i = 0; i < corners; ++i) mesh_.corners.push_back(FlatMesh::vertex_number(values_.index(p)));
            } else if (p.role == Role::texcoords) {
                has_texcoords = true;
                for (uint64_t n = values_.length(p); n > 0; --n) texcoords_.push_back(static_cast<float>(values_.number(p)));
            } else {
                pass_over(p);
            }
        }
        if (element.kind == Kind::strips) return;
        mesh_.add_face(corners);
        if (!has_texcoords) return;
        // MeshLab writes two numbers for each corner.
        const bool fits = texcoords_.size() == 2 * corners;
        const rt_u32 first = static_cast<rt_u32>(mesh_.corner_uvs.size() / 2);
        for (size_t i = 0; i < corners; ++i) mesh_.uv_of_corner.push_back(fits ? first + static_cast<rt_u32>(i) : RT_NONE);
        if (fits) mesh_.corner_uvs.insert(mesh_.corner_uvs.end(), texcoords_.begin(), texcoords_.end());
    }
    // Each index makes a triangle with the two before it, in turns of either sense. -1 begins a new strip. Triangles of two
    // equal corners only lead from one part of the strip to the next.
    void strip(const Property& p) {
        rt_u32 before[2] = {0, 0};
        uint64_t length = 0;
        for (uint64_t n = values_.length(p); n > 0; --n) {
            const int64_t index = values_.index(p);
            if (index < 0 || index == int64_t(0xFFFFFFFF)) {
                length = 0;
                continue;
            }
            const rt_u32 at = FlatMesh::vertex_number(index), a = before[length % 2 ? 1 : 0], b = before[length % 2 ? 0 : 1];
            if (length >= 2 && a != b && a != at && b != at) {
                for (const rt_u32 corner : {a, b, at}) mesh_.corners.push_back(corner);
                mesh_.add_face(3);
            }
            before[0] = before[1];
            before[1] = at;
            ++length;
        }
    }

    const Source& source_;
    const Header& header_;
    FlatMesh& mesh_;
    Place place_;
    Values values_;
    Steps steps_{source_};
    unsigned long long done_[4] = {0, 0, 0, 0};  // elements of each kind
    std::vector<float> texcoords_;
};

Header read_elements(const Source& source, FlatMesh& mesh, bool needs_faces) {
    Header header = ply::parse_header(source.bytes, needs_faces);
    if (header.is_ascii()) {
        ElementReader<AsciiValues>(source, header, mesh).read();
    } else if (header.format == "binary_little_endian") {
        ElementReader<BinaryValues<false>>(source, header, mesh, source.bytes.size()).read();
    } else {
        ElementReader<BinaryValues<true>>(source, header, mesh, source.bytes.size()).read();
    }
    return header;
}

}  // namespace

Reading read_ply(const Source& source, FlatMesh& mesh) {
    const Header header = read_elements(source, mesh, true);
    // Triangles of strips have no uvs of corners.
    if (!mesh.uv_of_corner.empty()) mesh.uv_of_corner.resize(mesh.corners.size(), RT_NONE);
    for (const Element& element : header.elements)
        if (element.has_colors() && element.kind == Kind::faces) warn(source, "its faces have colours, which are left out");
    Reading reading;
    reading.texture = header.texture;
    return reading;
}

Reading read_ply_points(const Source& source, FlatMesh& mesh) {
    (void)read_elements(source, mesh, false);
    return {};
}

}  // namespace openmesh_import
