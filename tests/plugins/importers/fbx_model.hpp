// fbx_model.hpp -- FBX scenes of a few objects, for tests.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fbx_writer.hpp"
#include "measure.hpp"

namespace clarity::test {

using Numbers = std::vector<double>;
using Indices = std::vector<int32_t>;

inline FbxNode node(const std::string& name, const std::vector<FbxNode::Value>& values,
                    const std::vector<FbxNode>& children = {}) {
    return {name, values, children};
}
inline FbxNode property(const std::string& name, const Numbers& numbers) {
    FbxNode out = node("P", {text(name), text(""), text(""), text("A")});
    for (const double x : numbers) out.values.push_back(x);
    return out;
}
inline FbxNode word(const std::string& name, const std::string& value) {
    return node("P", {text(name), text("KString"), text(""), text(""), text(value)});
}
inline FbxNode geometry(int64_t id, const std::vector<FbxNode>& layers = {}) {
    FbxNode out = node("Geometry", {whole(id), text("Geometry::Square"), text("Mesh")},
                       {node("Vertices", {Numbers{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}}),
                        node("PolygonVertexIndex", {Indices{0, 1, -3, 0, 2, -4}})});
    out.children.insert(out.children.end(), layers.begin(), layers.end());
    return out;
}
inline FbxNode model(int64_t id, const std::string& name, const std::vector<FbxNode>& properties = {}) {
    return node("Model", {whole(id), text("Model::" + name), text("Mesh")},
                {node("Version", {whole(232)}), node("Properties70", {}, properties)});
}
inline FbxNode link(int64_t from, int64_t to, const std::string& property = "") {
    FbxNode out = node("C", {text(property.empty() ? "OO" : "OP"), whole(from), whole(to)});
    if (!property.empty()) out.values.push_back(text(property));
    return out;
}

inline bool warns_of(const Scene& scene, const std::string& text) {
    for (const std::string& warning : scene.warnings) {
        if (warning.find(text) != warning.npos) return true;
    }
    return false;
}

class FbxForms : public testing::TestWithParam<FbxForm> {
 protected:
    Scene import(const std::vector<FbxNode>& objects, const std::vector<FbxNode>& links,
                 const std::string& creator = "by hand") {
        const std::string version = std::to_string(GetParam().version);
        const std::vector<FbxNode> all = {
            node("FBXHeaderExtension", {}, {node("FBXVersion", {whole(GetParam().version)})}), node("Creator", {text(creator)}),
            node("GlobalSettings", {}, {node("Version", {whole(1000)}), node("Properties70", {}, {property("TimeMode", {6})})}),
            node("Objects", {}, objects), node("Connections", {}, links)};
        return import_file(folder_.write("model.fbx", FbxWriter(GetParam()).file(all)));
    }
    Scratch folder_;
};
inline const auto kFbxForms =
    testing::Values(FbxForm{true, false, false, 7400}, FbxForm{true, true, false, 7700}, FbxForm{false, false, false, 7500});
inline std::string fbx_form_name(const testing::TestParamInfo<FbxForm>& form) {
    return std::string(form.param.binary ? "Binary" : "Ascii") + std::to_string(form.param.version);
}

}  // namespace clarity::test
