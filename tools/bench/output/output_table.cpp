// output_table.cpp -- records as tables for the terminal; what was compared stands side by side.
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "tools/bench/output/output.hpp"
#include "tools/bench/output/record.hpp"
#include "tools/bench/output/record_fields.hpp"
#include "tools/bench/output/speedup.hpp"
#include "tools/bench/output/text_table.hpp"

namespace clarity::bench {
namespace {

// Records grouped by a key, in the order of their keys' first records. The records must outlive the groups.
class RecordGroups {
 public:
    void add(const std::string& key, const BenchRecord& record) {
        const auto [place, fresh] = index_.try_emplace(key, groups_.size());
        if (fresh) groups_.emplace_back();
        groups_[place->second].push_back(&record);
    }
    const std::vector<std::vector<const BenchRecord*>>& all() const { return groups_; }

 private:
    std::map<std::string, size_t> index_;
    std::vector<std::vector<const BenchRecord*>> groups_;
};

bool shown(const BenchRecord& r) {
    return r.status == RowStatus::ok && r.time_ms.n > 0;
}

bool unsteady(const BenchReport& report, const BenchRecord& r) {
    const double most = report.run_of(r).max_spread;
    return r.status == RowStatus::refused && std::max(r.time_ms.spread(), r.wall_ms.spread()) > most;
}

const BenchRecord* find(const std::vector<const BenchRecord*>& group, const std::string& measure) {
    for (const BenchRecord* r : group)
        if (r->measure == measure) return r;
    return nullptr;
}

// True if all records are of one device; the tables then have no column for the device.
bool one_device(const BenchReport& report) {
    std::string first;
    for (const BenchRecord& r : report.records) {
        if (!r.baseline.empty() || r.measure == "build") continue;
        if (first.empty()) first = r.device;
        if (r.device != first) return false;
    }
    return true;
}

std::string device_cell(const BenchReport& report, const BenchRecord& r) {
    return one_device(report) ? std::string() : r.device;
}

// Frames per second by number of steps, as in the thesis's charts.
std::string steps_table(const BenchReport& report, const std::string& suite) {
    RecordGroups groups;
    std::map<std::string, const BenchRecord*> then;  // scene, device, depth -> row
    const auto key = [](const BenchRecord& r) { return r.scene + "\n" + r.device_id + r.device; };
    for (const BenchRecord& r : report.records) {
        if (r.suite != suite || r.measure != "frame" || !shown(r)) continue;
        groups.add(key(r) + "\n" + r.name(), r);
        if (r.variant == "then") then[key(r) + "\n" + std::to_string(r.depth)] = &r;
    }
    TextTable table({"scene", "", "device", "fps at 1 step", "2", "3", "4 steps", "kernel p50", "all in p50", "p95", "p99",
                     "spread %", "Mrays/s", "x then"},
                    3);
    for (const auto& group : groups.all()) {
        const BenchRecord& last = *group.back();
        std::vector<std::string> fps(5);
        for (const BenchRecord* r : group)
            if (r->depth >= 1 && r->depth <= 4) fps[r->depth] = short_number(r->fps);
        const auto naive = then.find(key(last) + "\n" + std::to_string(last.depth));
        Speedup by_then;
        if (naive != then.end() && last.variant != "then") by_then = speedup(last, *naive->second);
        table.add({last.scene, last.name(), device_cell(report, last), fps[1], fps[2], fps[3], fps[4],
                   short_number(last.time_ms.median), short_number(last.wall_ms.median), short_number(last.wall_ms.p95),
                   short_number(last.wall_ms.p99), percent(std::max(last.time_ms.spread(), last.wall_ms.spread())),
                   short_number(last.mrays_per_s),
                   about_same(by_then.ratio, by_then.spread) ? "same" : short_number(by_then.ratio)});
    }
    return table.empty()
               ? std::string()
               : suite +
                     ": frames per second, from the call to the pixels on the host; the right-hand columns are of the last "
                     "step:\nms, p95 and p99 of all in; same: about the same, the difference is within the measured spread\n" +
                     table.text(22) + "\n";
}

// Frames per second: packet sizes down, numbers of lanes across.
std::string packets_table(const BenchReport& report) {
    RecordGroups groups;
    std::vector<int> lanes;
    for (const BenchRecord& r : report.records) {
        if (r.suite != "packets" || !shown(r)) continue;
        groups.add(r.scene + "\n" + r.device + "\n" + std::to_string(r.packet_w * 1000 + r.packet_h), r);
        if (std::find(lanes.begin(), lanes.end(), r.lanes) == lanes.end()) lanes.push_back(r.lanes);
    }
    std::sort(lanes.begin(), lanes.end());
    std::vector<std::string> head = {"scene", "device", "packet"};
    for (const int l : lanes) head.push_back("fps, " + std::to_string(l) + (l == 1 ? " lane" : " lanes"));
    TextTable table(head, 3);
    for (const auto& group : groups.all()) {
        const BenchRecord& first = *group.front();
        std::vector<std::string> row = {first.scene, device_cell(report, first),
                                        std::to_string(first.packet_w) + "x" + std::to_string(first.packet_h)};
        for (const int l : lanes) {
            const auto at = std::find_if(group.begin(), group.end(), [&](const BenchRecord* r) { return r->lanes == l; });
            row.push_back(at == group.end() ? "" : short_number((*at)->fps));
        }
        table.add(row);
    }
    return table.empty() ? std::string() : "packets: frames per second at 4 steps\n" + table.text() + "\n";
}

// Sorts groups by scene, in the order of the scenes' first records; within a scene, our rows come before the baselines'.
std::vector<std::vector<const BenchRecord*>> ours_first(std::vector<std::vector<const BenchRecord*>> groups) {
    std::map<std::string, size_t> place;
    for (const auto& group : groups) place.emplace(group.front()->scene, place.size());
    std::stable_sort(groups.begin(), groups.end(), [&](const auto& a, const auto& b) {
        const auto rank = [&](const auto& group) {
            return std::make_pair(place.at(group.front()->scene), !group.front()->baseline.empty());
        };
        return rank(a) < rank(b);
    });
    return groups;
}

// Columns of a structure's costs, besides its build time.
constexpr const char* kBuildKeys[] = {"mtris_per_s", "page_faults", "bytes_per_triangle", "sah_cost"};

// One line per scene and structure or baseline: build costs and speed by kind of ray.
std::string accel_table(const BenchReport& report, const std::string& suite) {
    RecordGroups groups;
    for (const BenchRecord& r : report.records) {
        if (r.suite != suite || !shown(r) || r.measure == "dropped" || (suite == "quick" && r.measure == "frame")) continue;
        // A baseline is built once per quality and traced in several modes, so that its builds have lines of their own.
        groups.add(r.scene + "\n" + (r.measure == "build" || !r.baseline.empty() ? "" : r.device) + "\n" + r.name(), r);
    }
    // Our builds are shown in the lines of the same structure.
    std::vector<std::string> head = {"scene", "structure", "device", "triangles", "build ms"};
    for (const char* key : kBuildKeys) head.push_back(record_field(key).look.column);
    for (const char* word : {"primary", "shadow", "reflect", "diffuse", "frame ms", "worst +-%"}) head.push_back(word);
    TextTable table(head, 3);
    std::map<std::string, const BenchRecord*> builds;
    for (const auto& group : groups.all())
        if (const BenchRecord* build = find(group, "build")) builds[build->scene + "\n" + build->name()] = build;
    for (const auto& group : ours_first(groups.all())) {
        const BenchRecord& first = *group.front();
        const bool only_build = group.size() == 1 && first.measure == "build";
        if (only_build && first.baseline.empty()) {
            bool traced = false;
            for (const auto& other : groups.all())
                traced |=
                    other.front() != &first && other.front()->scene == first.scene && other.front()->name() == first.name();
            if (traced) continue;
        }
        const auto built = builds.find(first.scene + "\n" + first.name());
        const BenchRecord* build = built == builds.end() ? nullptr : built->second;
        double spread = 0;
        for (const BenchRecord* r : group) spread = std::max(spread, r->time_ms.spread());
        const auto rays = [&](const char* measure) {
            const BenchRecord* r = find(group, measure);
            return r ? short_number(r->mrays_per_s) : std::string();
        };
        const BenchRecord* frame = find(group, "frame");
        if (!frame) frame = find(group, "whitted");
        std::vector<std::string> cells = {first.scene, first.name(),
                                          only_build || !first.baseline.empty() ? "" : device_cell(report, first),
                                          std::to_string(first.triangles), build ? short_number(build->time_ms.median) : ""};
        for (const char* key : kBuildKeys) cells.push_back(build ? shown_text(record_field(key), *build) : "");
        for (const char* kind : {"primary", "shadow", "reflection", "diffuse"}) cells.push_back(rays(kind));
        cells.push_back(frame ? short_number(frame->time_ms.median) : "");
        cells.push_back(percent(spread));
        table.add(cells);
    }
    return table.empty() ? std::string() : suite + ": Mrays/s by kind of ray, p50\n" + table.text(28) + "\n";
}

std::string analysis_table(const BenchReport& report) {
    std::vector<std::string> head = {"scene", "rays", "structure"};
    for (const Field<Analysis>& field : analysis_fields())
        if (field.look.column) head.push_back(field.look.column);
    TextTable table(head, 3);
    bool marked = false;
    for (const BenchRecord& r : report.records) {
        // Counts hold in spite of unsteady times.
        if (!r.analysis.present || (r.status != RowStatus::ok && !unsteady(report, r))) continue;
        std::vector<std::string> cells = {r.scene, r.measure, r.name() + (r.analysis.reported.empty() ? "" : " *")};
        marked |= !r.analysis.reported.empty();
        for (const Field<Analysis>& field : analysis_fields())
            if (field.look.column) cells.push_back(shown_text(field, r.analysis));
        table.add(cells);
    }
    return table.empty() ? std::string()
                         : "what the packets did (counted, not timed; docs/bench.md defines each figure)\n" + table.text(26) +
                               (marked ? "*: the structure tests boxes by itself, and reports how many\n" : "") + "\n";
}

// What times mean, where they are by no clock.
std::string note_on_clock(const BenchReport& report) {
    for (const BenchRecord& r : report.records)
        if (!r.clock.empty())
            return "times by processors (--processor-time): ms are of all threads together, and Mrays/s are rays in a second "
                   "of one processor\n\n";
    return {};
}

// Which version of its peers was measured, a line each.
std::string note_on_peers(const BenchReport& report) {
    std::vector<std::string> versions;
    for (const BenchRecord& r : report.records)
        if (!r.baseline.empty() && !r.driver.empty() && std::find(versions.begin(), versions.end(), r.driver) == versions.end())
            versions.push_back(r.driver);
    std::string text;
    for (const std::string& version : versions) text += "peers: " + version + "\n";
    return text.empty() ? text : text + "\n";
}

// Joins the parts with commas, and breaks lines to fit a terminal of 120 columns.
std::string wrapped(std::string line, const std::vector<std::string>& parts) {
    std::string text;
    for (size_t i = 0; i < parts.size(); ++i) {
        const std::string part = parts[i] + (i + 1 < parts.size() ? "," : "");
        if (line.size() + part.size() + 1 > 118) {
            text += line + "\n";
            line = "        ";
        }
        line += " " + part;
    }
    return text + line + "\n";
}

// The rows of each case which were too unsteady, with their spread.
std::string refused_rows(const BenchReport& report) {
    RecordGroups groups;
    for (const BenchRecord& r : report.records)
        if (unsteady(report, r)) groups.add(r.suite + "\n" + r.case_name, r);
    std::string text;
    for (const auto& group : groups.all()) {
        std::vector<std::string> parts;
        for (const BenchRecord* r : group)
            parts.push_back(r->name() + (device_cell(report, *r).empty() || !r->baseline.empty() ? "" : " on " + r->device) +
                            " " + percent(std::max(r->time_ms.spread(), r->wall_ms.spread())) + " %");
        text += wrapped("REFUSED  " + group.front()->suite + " " + group.front()->case_name + ":", parts);
    }
    if (text.empty()) return text;
    const BenchRun& run = report.run_of(*groups.all().front().front());
    return text + "Refused: the spread above (the middle half of repetitions, relative to the median) exceeds " +
           percent(run.max_spread) + " %.\nClose other programs and measure again, or raise --max-spread or --time-limit.\n";
}

// Rows which were left out: rows of one scene with the same reason share a line.
std::string left_out(const BenchReport& report) {
    RecordGroups groups;
    for (const BenchRecord& r : report.records)
        if (r.status != RowStatus::ok && !unsteady(report, r))
            groups.add(std::to_string(static_cast<int>(r.status)) + r.suite + "\n" + r.scene + "\n" + r.name() + "\n" +
                           r.device + "\n" + (r.status == RowStatus::skipped ? r.why : r.case_name),
                       r);
    std::string text = refused_rows(report);
    for (const auto& group : groups.all()) {
        const BenchRecord& r = *group.front();
        const char* word = r.status == RowStatus::refused ? "REFUSED" : r.status == RowStatus::failed ? "FAILED" : "skipped";
        text += std::string(word) + "  " + r.suite + " " + r.case_name;
        for (size_t i = 1; i < group.size(); ++i) text += ", " + group[i]->case_name.substr(group[i]->case_name.rfind('/') + 1);
        if (!r.name().empty()) text += ", " + r.name();
        text += (r.baseline.empty() && !device_cell(report, r).empty() ? " on " + r.device : "") + ": " + r.why + "\n";
    }
    for (const std::string& note : report.notes) text += "left out  " + note + "\n";
    return text;
}

}  // namespace

std::string bench_table(const BenchReport& report) {
    return steps_table(report, "thesis") + steps_table(report, "quick") + packets_table(report) + accel_table(report, "quick") +
           accel_table(report, "accel") + accel_table(report, "scale") + accel_table(report, "cpu") + speedup_table(report) +
           light_table(report) + threads_table(report) + row_tables(report) + shapes_table(report) + note_on_peers(report) +
           note_on_clock(report) + analysis_table(report) + dropped_table(report) + left_out(report);
}

}  // namespace clarity::bench
