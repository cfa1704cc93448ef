// row_tables.cpp -- tables of one line a record: what a line is of, and its columns.
#include <algorithm>
#include <functional>

#include "tools/bench/output/output.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

using R = const BenchRecord&;

std::string cell_text(const std::string& text) {
    return text;
}
std::string cell_text(double value) {
    return short_number(value);
}
std::string cell_text(uint64_t count) {
    return std::to_string(count);
}
std::string cell_text(unsigned count) {
    return std::to_string(count);
}

struct Column {
    const char* head;
    std::function<std::string(R)> text;
};

// of: a member, or a function of the record. It gives a text, a count, or a number, which is shown with three digits.
template <class Of>
Column col(const char* head, Of of) {
    return {head, [of](R record) { return cell_text(std::invoke(of, record)); }};
}

// Of columns, the first `left` are texts, which are cut to `cell` characters.
struct RowTable {
    const char* title;
    bool (*has)(R record);
    size_t left, cell;
    std::vector<Column> columns;
};

template <class... Columns>
RowTable row_table(const char* title, bool (*has)(R record), size_t left, size_t cell, const Columns&... columns) {
    return {title, has, left, cell, {columns...}};
}

double median_ms(R r) {
    return r.time_ms.median;
}
double wall_ms(R r) {
    return r.wall_ms.median;
}
std::string worst_spread(R r) {
    return percent(std::max(r.time_ms.spread(), r.wall_ms.spread()));
}
std::string against(R r) {
    return ratio_text(r.speedup.ratio, r.speedup.spread, "same");
}
// What a case is of, besides its scene.
std::string last_of_name(R r) {
    return r.case_name.substr(r.case_name.rfind('/') + 1);
}

// A column of one of the named times.
Column part(const char* name, Parts BenchRecord::* of) {
    return col(name, [=](R r) {
        const auto at = std::find_if((r.*of).begin(), (r.*of).end(), [&](const auto& p) { return p.first == name; });
        return at == (r.*of).end() ? 0 : at->second;
    });
}

// Shares of the picture which the devices rendered, "0.510 0.490".
std::string shares(R r) {
    std::string text;
    for (const auto& [name, share] : r.kernels_ms)
        if (name.size() >= 6 && name.compare(name.size() - 6, 6, " share") == 0)
            text += (text.empty() ? "" : " ") + decimals(share, 3);
    return text;
}

double whole_s(R r) {
    double sum = 0;
    for (const auto& [name, ms] : r.parts_ms) sum += ms;
    return sum / 1000;
}

const RowTable kDropped = row_table(
    "rays dropped because a pixel's array was full, 4 steps", [](R r) { return r.measure == "dropped"; }, 1, 34,
    col("scene", &BenchRecord::scene), col("ray slots a pixel", [](R r) { return uint64_t(r.ray_slots); }),
    col("secondary rays", &BenchRecord::rays_secondary), col("dropped", &BenchRecord::rays_dropped), col("of them %", [](R r) {
        const double all = double(r.rays_secondary + r.rays_dropped);
        return all > 0 ? percent(double(r.rays_dropped) / all) : std::string();
    }));

const RowTable kTables[] = {
    row_table(
        "light: a first picture of 64x64, from the start of the program to its end; cold: nothing is kept from earlier",
        [](R r) { return r.measure == "start"; }, 3, 34, col("scene", &BenchRecord::scene), col("", &BenchRecord::variant),
        col("device", &BenchRecord::device_id), col("compile s", [](R r) { return median_ms(r) / 1000; }),
        col("whole s", [](R r) { return wall_ms(r) / 1000; })),
    row_table(
        "devices: a picture with all its samples, from the call to the pixels on the host, p50, or one of a hundred while the "
        "camera moves; kernels' times are the slowest device's\nsame: about the same, the difference is within the measured "
        "spread",
        [](R r) { return r.measure == "picture" || r.measure == "moving"; }, 3, 26, col("scene", &BenchRecord::scene),
        col("", &BenchRecord::variant), col("shares", shares), col("picture ms", wall_ms), col("traced ms", median_ms),
        part("tone map", &BenchRecord::kernels_ms), part("read-back", &BenchRecord::kernels_ms), col("spread %", worst_spread),
        col("x the first", against)),
    row_table(
        "mpi: a picture that ranks share, from the moment that all can trace until the first rank has it, p50; then the whole "
        "command, and where its time goes in the first rank, ms\nsame: about the same, the difference is within the measured "
        "spread",
        [](R r) { return r.measure == "ranks"; }, 3, 26, col("scene", &BenchRecord::scene), col("", &BenchRecord::variant),
        col("device", &BenchRecord::device_id), col("picture ms", wall_ms), col("spread %", worst_spread),
        col("x the first", against),
        col("efficiency %", [](R r) { return r.efficiency > 0 ? percent(r.efficiency) : std::string(); }),
        col("whole s", whole_s), part("start", &BenchRecord::parts_ms), part("import", &BenchRecord::parts_ms),
        part("share", &BenchRecord::parts_ms), part("build", &BenchRecord::parts_ms), part("wait", &BenchRecord::parts_ms),
        part("trace", &BenchRecord::parts_ms), part("collect", &BenchRecord::parts_ms)),
    row_table(
        "moving: a refit or a build from vertices in place to the finished structure; a whole frame, with its parts in ms; p50",
        [](R r) { return r.suite == "moving"; }, 3, 26, col("scene", &BenchRecord::scene), col("motion", last_of_name),
        col("", &BenchRecord::name), col("triangles", &BenchRecord::triangles), col("ms", median_ms),
        col("Mtri/s", &BenchRecord::mtris_per_s), col("Mrays/s", &BenchRecord::mrays_per_s),
        col("B/tri", &BenchRecord::bytes_per_triangle), col("SAH", &BenchRecord::sah_cost),
        col("spread %", [](R r) { return percent(r.time_ms.spread()); }), col("x baseline", against),
        part("pose", &BenchRecord::kernels_ms), part("deform", &BenchRecord::kernels_ms),
        part("update", &BenchRecord::kernels_ms), part("trace", &BenchRecord::kernels_ms),
        col("fps", [](R r) { return r.rays() == 0 && r.mtris_per_s == 0 ? r.fps : 0; })),
    row_table(
        "policy: 200 frames of an animation, ms of all of them; x the best: total, divided by that of the best fixed rule",
        [](R r) { return r.suite == "policy"; }, 3, 28, col("scene", &BenchRecord::scene), col("animation", last_of_name),
        col("", &BenchRecord::name), col("triangles", &BenchRecord::triangles),
        col("total ms", [](R r) { return r.animation.total_ms; }), col("updates", [](R r) { return r.animation.update_ms; }),
        col("traced", [](R r) { return r.animation.trace_ms; }), col("builds", [](R r) { return r.animation.builds; }),
        col("worst SAH", [](R r) { return r.animation.worst_cost_ratio; }),
        col("x the best", [](R r) { return decimals(r.animation.to_best, 3); }))};

std::string text_of(const RowTable& table, const BenchReport& report) {
    std::vector<std::string> cells;
    for (const Column& column : table.columns) cells.emplace_back(column.head);
    TextTable text(cells, table.left);
    for (R record : report.records) {
        if (record.status != RowStatus::ok || !table.has(record)) continue;
        cells.clear();
        for (const Column& column : table.columns) cells.push_back(column.text(record));
        text.add(cells);
    }
    return text.empty() ? std::string() : table.title + ("\n" + text.text(table.cell)) + "\n";
}

}  // namespace

std::string row_tables(const BenchReport& report) {
    std::string text;
    for (const RowTable& table : kTables) text += text_of(table, report);
    return text;
}

std::string dropped_table(const BenchReport& report) {
    return text_of(kDropped, report);
}

}  // namespace clarity::bench
