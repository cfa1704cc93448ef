// mesh_files.hpp -- imports files whose text a test writes.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.hpp"
#include "import/import.hpp"
#include "measure.hpp"

namespace clarity::test {

inline const std::string kMark = "\xEF\xBB\xBF";

// The text with other line ends.
inline std::string with_ends(std::string text, const std::string& end) {
    for (size_t at = text.find('\n'); at != text.npos; at = text.find('\n', at + end.size())) text.replace(at, 1, end);
    return text;
}

class MeshFiles : public testing::Test {
 protected:
    // importers: their parameters, "ID,key=value".
    Scene import(const std::string& name, const std::string& bytes, const std::vector<std::string>& importers = {}) {
        static const PluginRegistry plugins = PluginRegistry::discover();
        import::ImportOptions options;
        options.in_process = true;
        options.log_warnings = false;
        options.importers = importers;
        Progress progress;
        return import::import_scene(plugins, {folder_.write(name, bytes)}, options, progress);
    }
    // A square from (0,0,0) to (1,1,0), in two triangles.
    void expect_square(const std::string& name, const std::string& bytes) {
        try {
            const Scene scene = import(name, bytes);
            EXPECT_EQ(scene.triangle_count(), 2u) << name << "\n" << bytes;
            EXPECT_NEAR(scene.surface_area(), 1, 1e-6) << name << "\n" << bytes;
            EXPECT_EQ(bounds_error(scene.bounds(), {{0, 0, 0}, {1, 1, 0}}), 0) << name;
        } catch (const Error& error) {
            ADD_FAILURE() << error.what() << "\n" << bytes;
        }
    }
    // With every line end, with and without a mark.
    void expect_square_however_written(const std::string& name, const std::string& text) {
        for (const char* end : {"\n", "\r\n", "\r"}) {
            expect_square(name, with_ends(text, end));
            expect_square(name, kMark + with_ends(text, end));
        }
    }
    std::string refusal(const std::string& name, const std::string& bytes) {
        try {
            import(name, bytes);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    }
    void expect_refused(const std::string& name, const std::string& bytes, const std::string& why) {
        EXPECT_NE(refusal(name, bytes).find(why), std::string::npos) << refusal(name, bytes);
    }
    Scratch folder_;
};

inline bool warns(const Scene& scene, const std::string& of) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& warning) { return warning.find(of) != warning.npos; });
}
inline const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

}  // namespace clarity::test
