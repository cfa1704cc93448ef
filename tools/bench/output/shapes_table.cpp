// shapes_table.cpp -- shapes and their meshes side by side, and the error of a mesh from which on the shape is the cheaper one.
#include <cstdio>

#include "tools/bench/output/output.hpp"
#include "tools/bench/output/text_table.hpp"
#include "tools/bench/scenes/zoo_scenes.hpp"

namespace clarity::bench {
namespace {

// What the suite compares: of a shape, "torus", and of a mesh of it, "torus, 32 parts".
struct ShapeRow {
    const BenchRecord* record;
    std::string kind;
    unsigned parts;  // 0: the shape itself
    double error;
};

ShapeRow row_of_shape(const BenchRecord& record) {
    for (const MeshedShape& kind : meshed_shapes())
        for (const unsigned parts : kind.parts)
            if (record.scene == shape_mesh_name(kind.name, parts))
                return {&record, kind.name, parts, shape_mesh_error(kind.name, parts)};
    return {&record, record.scene, 0, 0};
}

// Two digits, however small; "" for 0.
std::string error_text(double error) {
    char text[24];
    std::snprintf(text, sizeof text, "%.2g", error);
    return error > 0 ? text : "";
}

bool is_mesh_of(const ShapeRow& mesh, const ShapeRow& shape) {
    const BenchRecord &a = *shape.record, &b = *mesh.record;
    return mesh.parts > 0 && mesh.kind == shape.kind && a.measure == b.measure && a.variant == b.variant &&
           a.device == b.device;
}

// Camera rays that hit the shape and not its mesh, in percent of those that hit the shape. Meshes of these shapes lie within
// them, nearly; what bulges out at a waist counts against it. "" of the shape itself and of other rays, which begin elsewhere.
std::string misses(const ShapeRow& mesh, const std::vector<ShapeRow>& rows) {
    for (const ShapeRow& shape : rows)
        if (shape.parts == 0 && mesh.record->measure == "primary" && is_mesh_of(mesh, shape) && shape.record->hits > 0) {
            const double all = double(shape.record->hits);
            return short_number(100 * (all - double(mesh.record->hits)) / all);
        }
    return {};
}

// What a row costs, in some measure; 0: not known.
struct Cost {
    const char* name;
    double (*of)(const BenchRecord& record);
};
const Cost kCosts[] = {
    {"memory", [](const BenchRecord& r) { return double(r.accel_bytes); }},
    {"nodes", [](const BenchRecord& r) { return r.analysis.nodes_per_ray; }},
    {"tests", [](const BenchRecord& r) { return r.analysis.leaf_tests_per_ray; }},
    {"time", [](const BenchRecord& r) { return r.mrays_per_s > 0 ? 1 / r.mrays_per_s : 0; }},
};

// The error of the coarsest mesh that costs more than the shape; "none": no mesh does.
std::string crossing(const ShapeRow& shape, const std::vector<ShapeRow>& rows, const Cost& cost) {
    const double own = cost.of(*shape.record);
    if (!(own > 0)) return {};
    for (const ShapeRow& mesh : rows) {
        if (is_mesh_of(mesh, shape) && cost.of(*mesh.record) > own) return mesh.error > 0 ? error_text(mesh.error) : "any";
    }
    return "none";
}

}  // namespace

std::string shapes_table(const BenchReport& report) {
    std::vector<ShapeRow> rows;
    for (const BenchRecord& r : report.records)
        if (r.suite == "shapes" && r.status == RowStatus::ok) rows.push_back(row_of_shape(r));
    TextTable all(
        {"shape or mesh", "rays", "structure", "error", "misses %", "triangles", "bytes", "nodes", "tests", "Mrays/s"}, 3);
    std::vector<std::string> head = {"shape", "rays", "structure"};
    for (const Cost& cost : kCosts) head.emplace_back(cost.name);
    TextTable crossings(head, 3);
    for (const ShapeRow& row : rows) {
        const BenchRecord& r = *row.record;
        all.add({r.scene, r.measure, r.name(), error_text(row.error), misses(row, rows), std::to_string(r.triangles),
                 std::to_string(r.accel_bytes), short_number(r.analysis.nodes_per_ray),
                 short_number(r.analysis.leaf_tests_per_ray), short_number(r.mrays_per_s)});
        if (row.parts > 0) continue;
        std::vector<std::string> cells = {row.kind, r.measure, r.name()};
        for (const Cost& cost : kCosts) cells.push_back(crossing(row, rows, cost));
        crossings.add(cells);
    }
    if (rows.empty()) return {};
    return "shapes: each as itself and as meshes; error: the greatest distance between the middle of an edge and the "
           "surface\n" +
           all.text(28) +
           "\nshapes: from which error of a mesh on, and below, the shape itself takes less (none: no mesh here takes more)\n" +
           crossings.text(28) + "\n";
}

}  // namespace clarity::bench
