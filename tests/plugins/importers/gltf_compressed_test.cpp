// gltf_compressed_test.cpp -- glTF files whose geometry Draco or meshoptimizer has compressed. The tests compress it with the
// encoders of these libraries, and compare with the same file without compression.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "gltf_model.hpp"
#include "import/import.hpp"
#include "measure.hpp"
#include "support/errors.hpp"
#ifdef CLARITY_HAVE_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif
#ifdef CLARITY_HAVE_DRACO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#pragma GCC diagnostic pop
#endif

namespace clarity::test {
namespace {

// A bumpy sheet of n by n squares.
struct Sheet {
    explicit Sheet(int n = 12) {
        for (int y = 0; y <= n; ++y)
            for (int x = 0; x <= n; ++x) {
                const float u = float(x) / float(n), v = float(y) / float(n);
                positions.insert(positions.end(), {u, v, 0.2f * std::sin(7 * u) * std::cos(5 * v)});
                uvs.insert(uvs.end(), {u, 1 - v});
                const float length = std::sqrt(u * u + v * v + 1);
                normals.insert(normals.end(), {u / length, v / length, 1 / length});
            }
        const auto at = [n](int x, int y) { return static_cast<uint32_t>(y * (n + 1) + x); };
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                indices.insert(indices.end(),
                               {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
    size_t vertex_count() const { return positions.size() / 3; }
    std::vector<float> positions, normals, uvs;
    std::vector<uint32_t> indices;
};

class GltfCompressed : public testing::Test {
 protected:
    Scene import(Model& model) { return import_file(folder_.write("model.gltf", model.text())); }
    void expect_refused(Model& model, const std::string& part) {
        expect_error([&] { import(model); }, {part});
    }
    // The same shape, wherever vertices and triangles are in their arrays.
    static void expect_same(const Scene& a, const Scene& b, double tolerance) {
        ASSERT_EQ(a.placed_triangle_count(), b.placed_triangle_count());
        EXPECT_NEAR(a.surface_area(), b.surface_area(), tolerance);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(a.bounds().min[k], b.bounds().min[k], tolerance);
            EXPECT_NEAR(a.bounds().max[k], b.bounds().max[k], tolerance);
        }
    }
    Scratch folder_;
};

Model plain(const Sheet& sheet) {
    Model model;
    model.positions(sheet.positions);
    model.primitive()["attributes"]["NORMAL"] = model.add(sheet.normals, "VEC3", 5126, 3);
    model.primitive()["attributes"]["TEXCOORD_0"] = model.add(sheet.uvs, "VEC2", 5126, 2);
    model.primitive()["indices"] = model.add(sheet.indices, "SCALAR", 5125, 1);
    return model;
}

// ---- KHR_mesh_quantization

TEST_F(GltfCompressed, ReadsQuantizedAttributes) {
    const Sheet sheet(6);
    Model exact = plain(sheet), model;
    model["extensionsRequired"] = {"KHR_mesh_quantization"};
    std::vector<int16_t> positions;  // VEC3 with a padding number, so that each begins at a multiple of 4
    std::vector<uint16_t> uvs;
    std::vector<int8_t> normals;
    for (size_t v = 0; v < sheet.vertex_count(); ++v) {
        for (int k = 0; k < 3; ++k) {
            positions.push_back(static_cast<int16_t>(std::lround(32767 * sheet.positions[3 * v + k])));
            normals.push_back(static_cast<int8_t>(std::lround(127 * sheet.normals[3 * v + k])));
        }
        positions.push_back(0), normals.push_back(0);
        for (int k = 0; k < 2; ++k) uvs.push_back(static_cast<uint16_t>(std::lround(65535 * sheet.uvs[2 * v + k])));
    }
    const auto add = [&](const auto& values, const char* type, int component_type, bool is_padded) {
        const size_t per_vertex = values.size() / sheet.vertex_count();
        const size_t accessor = model.add(values, type, component_type, per_vertex);
        model["accessors"][accessor]["normalized"] = true;
        if (is_padded) model["bufferViews"][accessor]["byteStride"] = per_vertex * sizeof(values[0]);
        return accessor;
    };
    model.primitive()["attributes"] = {{"POSITION", add(positions, "VEC3", 5122, true)},
                                       {"NORMAL", add(normals, "VEC3", 5120, true)},
                                       {"TEXCOORD_0", add(uvs, "VEC2", 5123, false)}};
    model.primitive()["indices"] = model.add(sheet.indices, "SCALAR", 5125, 1);
    const Scene a = import(exact), b = import(model);
    expect_same(a, b, 1e-4);
    for (size_t i = 0; i < a.uvs.size(); ++i) EXPECT_NEAR(a.uvs[i], b.uvs[i], 1e-4);
    for (size_t i = 0; i < a.normals.size(); ++i) EXPECT_NEAR(a.normals[i], b.normals[i], 2e-2);
    // Not normalized: the node brings whole numbers back to size.
    for (const char* attribute : {"POSITION"})
        model["accessors"][model.primitive()["attributes"][attribute].get<size_t>()].erase("normalized");
    model["nodes"][0]["scale"] = {1 / 32767.0, 1 / 32767.0, 1 / 32767.0};
    expect_same(a, import(model), 1e-4);
}

#ifdef CLARITY_HAVE_MESHOPTIMIZER

std::string vertices_encoded(const void* values, size_t count, size_t stride) {
    std::string out(meshopt_encodeVertexBufferBound(count, stride), '\0');
    out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), values, count, stride));
    return out;
}

// A view of the fallback buffer whose data is in `encoded`; returns its index.
size_t add_meshopt(Model& model, const std::string& encoded, size_t count, size_t stride, const char* mode,
                   const char* filter = nullptr) {
    const size_t view = model.add_view(encoded);
    json& json_view = model["bufferViews"][view];
    json extension = {{"buffer", 0},
                      {"byteOffset", json_view["byteOffset"]},
                      {"byteLength", encoded.size()},
                      {"byteStride", stride},
                      {"count", count},
                      {"mode", mode}};
    if (filter) extension["filter"] = filter;
    json_view = {{"buffer", 1},
                 {"byteOffset", 0},
                 {"byteLength", count * stride},
                 {"extensions", {{"EXT_meshopt_compression", extension}}}};
    if (std::string(mode) == "ATTRIBUTES") json_view["byteStride"] = stride;
    return view;
}

size_t add_accessor(Model& model, size_t view, size_t count, const char* type, int component_type, bool normalized = false) {
    model["accessors"].push_back({{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
    if (normalized) model["accessors"].back()["normalized"] = true;
    return model["accessors"].size() - 1;
}

class Meshopt : public GltfCompressed {
 protected:
    Scene import(Model& model) { return import_file(folder_.write("model.gltf", text(model))); }
    // With the fallback buffer, which has no data.
    static std::string text(Model& model) {
        json file = json::parse(model.text());
        file["buffers"].push_back(
            {{"byteLength", 1 << 20}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
        file["extensionsRequired"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
        return file.dump();
    }
    void expect_refused(Model& model, const std::string& part) {
        expect_error([&] { import(model); }, {part});
    }
    // Floats without filter, with triangles or a sequence of indices of 2 or 4 bytes.
    Model compressed(const Sheet& sheet, const char* mode = "TRIANGLES", size_t index_bytes = 2) {
        Model model;
        const size_t n = sheet.vertex_count(), count = sheet.indices.size();
        model.primitive()["attributes"]["POSITION"] = add_accessor(
            model, add_meshopt(model, vertices_encoded(sheet.positions.data(), n, 12), n, 12, "ATTRIBUTES"), n, "VEC3", 5126);
        const bool is_triangles = std::string(mode) == "TRIANGLES";
        std::string encoded(
            is_triangles ? meshopt_encodeIndexBufferBound(count, n) : meshopt_encodeIndexSequenceBound(count, n), '\0');
        auto* const to = reinterpret_cast<unsigned char*>(encoded.data());
        encoded.resize(is_triangles ? meshopt_encodeIndexBuffer(to, encoded.size(), sheet.indices.data(), count)
                                    : meshopt_encodeIndexSequence(to, encoded.size(), sheet.indices.data(), count));
        model.primitive()["indices"] = add_accessor(model, add_meshopt(model, encoded, count, index_bytes, mode), count,
                                                    "SCALAR", index_bytes == 2 ? 5123 : 5125);
        return model;
    }
};

TEST_F(Meshopt, ReadsVerticesAndIndices) {
    const Sheet sheet;
    Model exact = plain(sheet);
    const Scene wanted = GltfCompressed::import(exact);
    for (const char* mode : {"TRIANGLES", "INDICES"})
        for (const size_t index_bytes : {2, 4}) {
            Model model = compressed(sheet, mode, index_bytes);
            const Scene scene = import(model);
            expect_same(scene, wanted, 1e-6);
            EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
        }
    Model model = compressed(sheet);
    json renamed = json::parse(text(model));
    for (json& view : renamed["bufferViews"]) {
        view["extensions"]["KHR_meshopt_compression"] = view["extensions"]["EXT_meshopt_compression"];
        view["extensions"].erase("EXT_meshopt_compression");
    }
    expect_same(import_file(folder_.write("renamed.gltf", renamed.dump())), wanted, 1e-6);
}

TEST_F(Meshopt, UndoesItsFilters) {
    const Sheet sheet;
    const size_t n = sheet.vertex_count();
    Model exact = plain(sheet), model = compressed(sheet);
    // Normals, octahedral in 8 bits.
    std::vector<float> normals;
    for (size_t v = 0; v < n; ++v) {
        normals.insert(normals.end(), &sheet.normals[3 * v], &sheet.normals[3 * v] + 3);
        normals.push_back(0);
    }
    std::vector<int8_t> oct(4 * n);
    meshopt_encodeFilterOct(oct.data(), n, 4, 8, normals.data());
    model.primitive()["attributes"]["NORMAL"] = add_accessor(
        model, add_meshopt(model, vertices_encoded(oct.data(), n, 4), n, 4, "ATTRIBUTES", "OCTAHEDRAL"), n, "VEC3", 5120, true);
    // Texture coordinates, exponential.
    std::vector<uint32_t> exponential(2 * n);
#if MESHOPTIMIZER_VERSION >= 190  // it asks which numbers share an exponent; before, those of a vector did
    meshopt_encodeFilterExp(exponential.data(), n, 8, 15, sheet.uvs.data(), meshopt_EncodeExpSharedVector);
#else
    meshopt_encodeFilterExp(exponential.data(), n, 8, 15, sheet.uvs.data());
#endif
    model.primitive()["attributes"]["TEXCOORD_0"] =
        add_accessor(model, add_meshopt(model, vertices_encoded(exponential.data(), n, 8), n, 8, "ATTRIBUTES", "EXPONENTIAL"),
                     n, "VEC2", 5126);
    // An animation whose rotations are quaternions in 16 bits.
    const float turns[] = {0, 0, 0, 1, 0, 0, std::sqrt(0.5f), std::sqrt(0.5f)};
    std::vector<int16_t> quaternions(8);
    meshopt_encodeFilterQuat(quaternions.data(), 2, 8, 16, turns);
    const size_t output =
        add_accessor(model, add_meshopt(model, vertices_encoded(quaternions.data(), 2, 8), 2, 8, "ATTRIBUTES", "QUATERNION"), 2,
                     "VEC4", 5122, true);
    model["animations"] = {
        {{"samplers", {{{"input", model.add(std::vector<float>{0, 1}, "SCALAR", 5126, 1)}, {"output", output}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}}}}}};
    // add() and add_accessor() count views differently: an accessor names its view.
    model["accessors"].back()["bufferView"] = model["bufferViews"].size() - 1;
    const Scene wanted = GltfCompressed::import(exact), scene = import(model);
    expect_same(scene, wanted, 1e-6);
    ASSERT_EQ(scene.normals.size(), wanted.normals.size());
    for (size_t i = 0; i < wanted.normals.size(); ++i) EXPECT_NEAR(scene.normals[i], wanted.normals[i], 0.03);
    ASSERT_EQ(scene.uvs.size(), wanted.uvs.size());
    for (size_t i = 0; i < wanted.uvs.size(); ++i) EXPECT_NEAR(scene.uvs[i], wanted.uvs[i], 1e-3);
    ASSERT_EQ(scene.motion.key_values.size(), 8u);
    for (int i = 0; i < 8; ++i) EXPECT_NEAR(scene.motion.key_values[i], turns[i], 1e-3);
}

TEST_F(Meshopt, TakesTheFallbackWhereItHasData) {
    const Sheet sheet;
    Model exact = plain(sheet), model = compressed(sheet);
    json file = json::parse(text(model));
    std::string bytes(reinterpret_cast<const char*>(sheet.positions.data()), 4 * sheet.positions.size());
    const size_t indices_at = bytes.size();
    for (const uint32_t i : sheet.indices) {
        const auto small = static_cast<uint16_t>(i);
        bytes.append(reinterpret_cast<const char*>(&small), 2);
    }
    file["buffers"][1] = {{"byteLength", bytes.size()}, {"uri", "data:;base64," + base64(bytes)}};
    file["bufferViews"][1]["byteOffset"] = indices_at;
    for (json& view : file["bufferViews"]) view["extensions"]["EXT_meshopt_compression"]["byteLength"] = 9;
    const Scene scene = import_file(folder_.write("model.gltf", file.dump()));
    expect_same(scene, GltfCompressed::import(exact), 1e-6);
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_NE(scene.warnings[0].find("; the data without compression is taken"), std::string::npos) << scene.warnings[0];
}

TEST_F(Meshopt, RefusesWhatIsWrong) {
    const auto refused = [&](const std::string& part, const std::function<void(json&, Model&)>& edit, size_t view = 0) {
        Model model = compressed(Sheet());
        edit(model["bufferViews"][view]["extensions"]["EXT_meshopt_compression"], model);
        expect_refused(model, part);
    };
    refused("EXT_meshopt_compression.mode: found 'POINTS', expected 'ATTRIBUTES', 'TRIANGLES' or 'INDICES'",
            [](json& e, Model&) { e["mode"] = "POINTS"; });
    refused("byteStride: found 6, expected a multiple of 4 up to 256", [](json& e, Model&) { e["byteStride"] = 6; });
    refused("byteStride: found 260", [](json& e, Model&) { e["byteStride"] = 260; });
    refused("byteStride: found 0", [](json& e, Model&) { e["byteStride"] = 0; });
    refused("byteStride: found 12, expected 4 or 8 with the filter 'OCTAHEDRAL'",
            [](json& e, Model&) { e["filter"] = "OCTAHEDRAL"; });
    refused("byteStride: found 12, expected 8 with the filter 'QUATERNION'",
            [](json& e, Model&) { e["filter"] = "QUATERNION"; });
    refused("filter: found 'BLUR'", [](json& e, Model&) { e["filter"] = "BLUR"; });
    refused("filter: found 'EXPONENTIAL', expected 'NONE'", [](json& e, Model&) { e["filter"] = "EXPONENTIAL"; }, 1);
    refused("count: found 865, expected a multiple of 3", [](json& e, Model&) { e["count"] = 865; }, 1);
    refused("byteStride: found 8, expected 2 or 4", [](json& e, Model&) { e["byteStride"] = 8; }, 1);
    refused("count: found 4000000000000, expected as many elements as", [](json& e, Model&) { e["count"] = 4000000000000; });
    refused("bytes that meshoptimizer cannot decode",
            [](json& e, Model&) { e["byteOffset"] = e["byteOffset"].get<int>() + 4; });
    refused("bytes that meshoptimizer cannot decode",
            [](json& e, Model&) { e["byteLength"] = e["byteLength"].get<int>() - 5; });
    refused("expected them inside of the", [](json& e, Model&) { e["byteLength"] = 1 << 30; });
    refused("buffer: found 6", [](json& e, Model&) { e["buffer"] = 6; });
    // More in the accessor than the view has.
    refused("accessors[0]: found", [](json& e, Model&) { e["count"] = e["count"].get<int>() - 1; });
}

// Whatever the bytes are, there is a scene or a message.
TEST_F(Meshopt, SurvivesDamagedBytes) {
    Model model = compressed(Sheet(5));
    const std::string good = text(model);
    json file = json::parse(good);
    uint32_t seed = 1;
    for (int round = 0; round < 25; ++round) {
        std::string bytes = model.bytes();
        for (int k = 0; k < 3; ++k) {
            seed = seed * 1664525 + 1013904223;
            bytes[(seed >> 8) % bytes.size()] = static_cast<char>(seed >> 24);
        }
        file["buffers"][0]["uri"] = "data:;base64," + base64(bytes);
        try {
            import_file(folder_.write("model.gltf", file.dump()));
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).find("crash"), std::string::npos) << error.what();
        }
    }
}

#endif
#ifdef CLARITY_HAVE_DRACO

// A sheet that Draco has compressed, with its attributes by id.
struct DracoSheet {
    explicit DracoSheet(const Sheet& sheet, int method = draco::MESH_EDGEBREAKER_ENCODING, int bits = 16,
                        const std::vector<uint8_t>& joints = {}, const std::vector<float>& weights = {}) {
        draco::Mesh mesh;
        const size_t n = sheet.vertex_count();
        mesh.set_num_points(static_cast<uint32_t>(n));
        const auto add = [&](draco::GeometryAttribute::Type type, int components, draco::DataType data, const void* values,
                             size_t bytes) {
            draco::GeometryAttribute attribute;
            attribute.Init(type, nullptr, static_cast<int8_t>(components), data, false, static_cast<int64_t>(bytes), 0);
            const int id = mesh.AddAttribute(attribute, true, static_cast<uint32_t>(n));
            for (uint32_t v = 0; v < n; ++v)
                mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v),
                                                      static_cast<const char*>(values) + v * bytes);
            return mesh.attribute(id)->unique_id();
        };
        using Attribute = draco::GeometryAttribute;
        // The order and the ids are not those of the file's attributes.
        ids["TEXCOORD_0"] = add(Attribute::TEX_COORD, 2, draco::DT_FLOAT32, sheet.uvs.data(), 8);
        if (!joints.empty()) ids["JOINTS_0"] = add(Attribute::GENERIC, 4, draco::DT_UINT8, joints.data(), 4);
        if (!weights.empty()) ids["WEIGHTS_0"] = add(Attribute::GENERIC, 4, draco::DT_FLOAT32, weights.data(), 16);
        ids["POSITION"] = add(Attribute::POSITION, 3, draco::DT_FLOAT32, sheet.positions.data(), 12);
        ids["NORMAL"] = add(Attribute::NORMAL, 3, draco::DT_FLOAT32, sheet.normals.data(), 12);
        mesh.SetNumFaces(sheet.indices.size() / 3);
        for (uint32_t f = 0; f < sheet.indices.size() / 3; ++f) {
            draco::Mesh::Face face;
            for (uint32_t k = 0; k < 3; ++k) face[k] = draco::PointIndex(sheet.indices[3 * f + k]);
            mesh.SetFace(draco::FaceIndex(f), face);
        }
        draco::Encoder encoder;
        encoder.SetEncodingMethod(method);
        if (bits > 0)
            for (const auto type : {Attribute::POSITION, Attribute::NORMAL, Attribute::TEX_COORD})
                encoder.SetAttributeQuantization(type, bits);
        draco::EncoderBuffer buffer;
        if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok()) throw std::runtime_error("cannot encode");
        bytes.assign(buffer.data(), buffer.size());
    }
    std::map<std::string, uint32_t> ids;
    std::string bytes;
};

Model with_draco(const Sheet& sheet, const DracoSheet& draco) {
    Model model;
    const auto accessor = [&](size_t count, const char* type, int component_type) {
        model["accessors"].push_back({{"componentType", component_type}, {"count", count}, {"type", type}});
        return model["accessors"].size() - 1;
    };
    const size_t n = sheet.vertex_count();
    model.primitive()["attributes"] = {{"POSITION", accessor(n, "VEC3", 5126)},
                                       {"NORMAL", accessor(n, "VEC3", 5126)},
                                       {"TEXCOORD_0", accessor(n, "VEC2", 5126)}};
    if (draco.ids.count("JOINTS_0")) {
        model.primitive()["attributes"]["JOINTS_0"] = accessor(n, "VEC4", 5121);
        model.primitive()["attributes"]["WEIGHTS_0"] = accessor(n, "VEC4", 5126);
    }
    model.primitive()["indices"] = accessor(sheet.indices.size(), "SCALAR", 5125);
    json ids = json::object();
    for (const auto& [name, id] : draco.ids) ids[name] = id;
    model.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", model.add_view(draco.bytes)},
                                                                     {"attributes", ids}};
    model["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return model;
}

class Draco : public GltfCompressed {};

TEST_F(Draco, ReadsBothMethods) {
    const Sheet sheet;
    Model exact = plain(sheet);
    const Scene wanted = import(exact);
    for (const int method : {int(draco::MESH_EDGEBREAKER_ENCODING), int(draco::MESH_SEQUENTIAL_ENCODING)})
        for (const int bits : {0, 14}) {
            SCOPED_TRACE(std::to_string(method) + ", " + std::to_string(bits) + " bits");
            Model model = with_draco(sheet, DracoSheet(sheet, method, bits));
            const Scene scene = import(model);
            expect_same(scene, wanted, 1e-3);
            EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
            // Vertices are in another order. Each has the texture coordinates and the normal of its place.
            ASSERT_EQ(scene.uvs.size() / 2, scene.positions.size() / 3);
            for (size_t v = 0; v < scene.vertex_count(); ++v) {
                const float *const p = &scene.positions[3 * v], *const normal = &scene.normals[3 * v];
                EXPECT_NEAR(scene.uvs[2 * v], p[0], 2e-3);
                EXPECT_NEAR(scene.uvs[2 * v + 1], p[1], 2e-3);
                const float length = std::sqrt(p[0] * p[0] + p[1] * p[1] + 1);
                EXPECT_NEAR(normal[0], p[0] / length, 2e-3);
                EXPECT_NEAR(normal[2], 1 / length, 2e-3);
            }
        }
}

TEST_F(Draco, ReadsSkinsAndMorphs) {
    const Sheet sheet(4);
    const size_t n = sheet.vertex_count();
    std::vector<uint8_t> joints(4 * n);
    std::vector<float> weights(4 * n), up;
    for (size_t v = 0; v < n; ++v) {
        joints[4 * v] = sheet.positions[3 * v] > 0.4f;  // the right half follows the second joint
        weights[4 * v] = 1;
        up.insert(up.end(), {0, 0, 2});
    }
    // Sequential, because the other method gives vertices another order, and targets are not compressed.
    Model model = with_draco(sheet, DracoSheet(sheet, draco::MESH_SEQUENTIAL_ENCODING, 0, joints, weights));
    model.add(up, "VEC3", 5126, 3);
    model["accessors"].back()["bufferView"] = model["bufferViews"].size() - 1;
    model.primitive()["targets"] = {{{"POSITION", model["accessors"].size() - 1}}};
    model["meshes"][0]["weights"] = {1};
    model["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {0, 50, 0}}},
                      {{"name", "left"}},
                      {{"name", "right"}, {"translation", {3, 0, 0}}}};
    model["scenes"][0]["nodes"] = {0, 1, 2};
    model["skins"] = {{{"joints", {1, 2}}}};
    const Scene scene = import(model);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    EXPECT_NEAR(scene.bounds().min[0], 0, 1e-4);
    EXPECT_NEAR(scene.bounds().max[0], 4, 1e-4);
    EXPECT_NEAR(scene.bounds().max[1], 1, 1e-4);
    EXPECT_GT(scene.bounds().min[2], 1.7f);
    EXPECT_LT(scene.bounds().max[2], 2.3f);
}

TEST_F(Draco, TakesPlainDataWhereItIsBroken) {
    const Sheet sheet(4);
    Model exact = plain(sheet), model = plain(sheet);
    model.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
    const Scene scene = import(model);
    expect_same(scene, import(exact), 1e-6);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("bytes that Draco cannot decode"), std::string::npos) << scene.warnings[0];
}

// Positions need not be compressed. Where they are more than what is, the rest was read past its end.
TEST_F(Draco, LeavesOutWhatDoesNotFitPlainPositions) {
    const Sheet sheet(4);
    Model model = with_draco(sheet, DracoSheet(sheet));
    model.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"].erase("POSITION");
    std::vector<float> positions = sheet.positions;
    model.positions(positions);
    EXPECT_TRUE(import(model).warnings.empty());
    positions.insert(positions.end(), 3000, 0.5f);
    model.positions(positions);
    const Scene scene = import(model);
    EXPECT_EQ(scene.vertex_count(), sheet.vertex_count() + 1000);
    ASSERT_EQ(scene.warnings.size(), 2u);
    for (size_t i : {0, 1})
        EXPECT_NE(scene.warnings[i].find("in what Draco has compressed, expected "), std::string::npos) << scene.warnings[i];
}

TEST_F(Draco, RefusesWhatIsWrong) {
    const Sheet sheet(4);
    const DracoSheet draco(sheet);
    const auto refused = [&](const std::string& part, const std::function<void(json&, Model&)>& edit) {
        Model model = with_draco(sheet, draco);
        edit(model.primitive()["extensions"]["KHR_draco_mesh_compression"], model);
        expect_refused(model, part);
    };
    refused("KHR_draco_mesh_compression.bufferView: found 8", [](json& e, Model&) { e["bufferView"] = 8; });
    refused("KHR_draco_mesh_compression: found no member 'attributes'", [](json& e, Model&) { e.erase("attributes"); });
    refused("attributes.POSITION: found 77, expected the id of an attribute in the compressed mesh",
            [](json& e, Model&) { e["attributes"]["POSITION"] = 77; });
    refused("attributes.POSITION: found an attribute of 2 numbers, expected 3 for each vertex",
            [&](json& e, Model&) { e["attributes"]["POSITION"] = draco.ids.at("TEXCOORD_0"); });
    refused("bytes that Draco cannot decode",
            [](json&, Model& m) { m["bufferViews"][0]["byteLength"] = m["bufferViews"][0]["byteLength"].get<int>() / 2; });
}

TEST_F(Draco, SurvivesDamagedBytes) {
    const Sheet sheet(5);
    const DracoSheet draco(sheet);
    uint32_t seed = 7;
    for (int round = 0; round < 25; ++round) {
        DracoSheet damaged = draco;
        for (int k = 0; k < 3; ++k) {
            seed = seed * 1664525 + 1013904223;
            damaged.bytes[(seed >> 8) % damaged.bytes.size()] = static_cast<char>(seed >> 24);
        }
        Model model = with_draco(sheet, damaged);
        try {
            import(model);
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).find("crash"), std::string::npos) << error.what();
        }
    }
}

#endif

}  // namespace
}  // namespace clarity::test
