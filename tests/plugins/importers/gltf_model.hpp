// gltf_model.hpp -- small glTF files that tests put together.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clarity::test {

using nlohmann::json;

inline std::string base64(const std::string& bytes) {
    static const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return out;
}

// A scene of one mesh of one primitive.
class Model {
 public:
    Model() {
        json_ = {{"asset", {{"version", "2.0"}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"nodes", {{{"mesh", 0}}}},
                 {"meshes", {{{"primitives", {{{"attributes", json::object()}}}}}}}};
    }
    json& operator[](const char* key) { return json_[key]; }
    json& primitive() { return json_["meshes"][0]["primitives"][0]; }

    // Returns the index of a new accessor.
    template <class T>
    size_t add(const std::vector<T>& values, const char* type, int component_type, size_t components) {
        json_["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", values.size() * sizeof(T)}});
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        json_["accessors"].push_back({{"bufferView", json_["bufferViews"].size() - 1},
                                      {"componentType", component_type},
                                      {"count", values.size() / components},
                                      {"type", type}});
        return json_["accessors"].size() - 1;
    }
    void positions(const std::vector<float>& values) { primitive()["attributes"]["POSITION"] = add(values, "VEC3", 5126, 3); }
    void indices(const std::vector<uint16_t>& values) { primitive()["indices"] = add(values, "SCALAR", 5123, 1); }
    std::string text() {
        json_["buffers"] = {{{"byteLength", bytes_.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes_)}}};
        return json_.dump(1);
    }
    std::string glb() {
        json_["buffers"] = {{{"byteLength", bytes_.size()}}};
        std::string text = json_.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const auto u32 = [](size_t value) {
            const auto small = static_cast<uint32_t>(value);
            return std::string(reinterpret_cast<const char*>(&small), 4);
        };
        const std::string chunks = u32(text.size()) + "JSON" + text + u32(bytes_.size()) + std::string("BIN\0", 4) + bytes_;
        return "glTF" + u32(2) + u32(12 + chunks.size()) + chunks;
    }
    const std::string& bytes() const { return bytes_; }
    // Appends bytes to the buffer; returns the index of a new view of them.
    size_t add_view(const std::string& bytes) {
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
        json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}});
        bytes_ += bytes;
        return json_["bufferViews"].size() - 1;
    }

 private:
    json json_;
    std::string bytes_;
};

// Four corners of a unit square in the xy plane.
inline Model quad() {
    Model model;
    model.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    return model;
}

}  // namespace clarity::test
