// models.hpp -- models that take a while to import and build.
#pragma once
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "window_driver.hpp"

namespace clarity::ui {

// Writes a wavy sheet of 2 n^2 triangles.
inline void write_sheet(const std::string& path, int n) {
    std::ofstream out(path);
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x)
            out << "v " << double(x) / n << " " << 0.1 * std::sin(x * 0.37) * std::cos(y * 0.23) << " " << double(y) / n
                << "\n";
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const int a = y * (n + 1) + x + 1;
            out << "f " << a << " " << a + 1 << " " << a + n + 2 << "\nf " << a << " " << a + n + 2 << " " << a + n + 1 << "\n";
        }
}

// Returns the dragon of 871 k triangles if it is there, otherwise a sheet with about as many.
inline std::string large_model(const TemporaryFolder& folder) {
    const std::string packed = shared_path("scenes/models/dragon_871k.ply.gz"), path = folder.path() + "/dragon.ply";
    if (!packed.empty() && std::system(("gzip -dc '" + packed + "' > '" + path + "'").c_str()) == 0) return path;
    write_sheet(folder.path() + "/sheet.obj", 650);
    return folder.path() + "/sheet.obj";
}

}  // namespace clarity::ui
