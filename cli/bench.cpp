// clarity bench: measures suites or scenes, and writes the records as table, JSON, CSV and a page.
#include "tools/bench/run/bench.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "tools/bench/output/output.hpp"
#include "tools/bench/output/rows_file.hpp"
#include "tools/bench/report/report.hpp"
#include "tools/bench/run/program.hpp"

namespace clarity {
using namespace bench;
namespace {

bool is_suite(const std::string& word) {
    const std::vector<std::string>& names = suite_names();
    return std::find(names.begin(), names.end(), word) != names.end();
}

BenchRequest make_request(const BenchCommand& command) {
    BenchRequest request;
    for (const std::string& word : command.what) {
        const bool file = !is_suite(word) && (std::filesystem::exists(word) || word.find_first_of("./") != std::string::npos);
        (file ? request.files : request.suites).push_back(word);
    }
    check_scene_files(request.files);
    request.accels = command.accels;
    for (const std::string& pair : command.sets) {
        const size_t equals = pair.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Error(Exit::usage, "--set " + pair + ": expected key=value, as in --set shadows=false");
        request.settings.emplace_back(pair.substr(0, equals), pair.substr(equals + 1));
    }
    request.settings.insert(request.settings.end(), command.settings.begin(), command.settings.end());
    for (const auto& [key, value] : request.settings) {
        const auto only = [&](const char* suite) { return request.suites == std::vector<std::string>{suite}; };
        const bool whole = only("devices") || only("mpi") || only("light");
        if (key == "spp" && value != "1" && !whole)
            throw Error(Exit::usage, "--spp " + value + ": frames of one sample are timed; leave it out");
        if (key == "aov" && value != "color")
            throw Error(Exit::usage, "--aov " + value + ": frames are timed in colour only; leave it out");
    }
    request.only = command.only;
    request.max_triangles = command.max_triangles;
    if (!command.ranks.empty()) request.ranks = command.ranks;
    if (!command.mpirun.empty()) request.mpirun = command.mpirun;
    request.reference = command.reference;
    request.time_limit_s = command.time_limit_s;
    request.baselines = !command.no_baselines;
    return request;
}

void print_list(const Suite& suite) {
    for (const BenchCase& c : suite.cases) {
        std::string members;
        for (const Variant& variant : c.variants) members += (members.empty() ? "" : " | ") + variant.label;
        for (const std::string& quality : c.baseline_qualities) members += " | peers " + quality;
        std::printf("%-8s %-40s %s%s\n", c.suite.c_str(), c.name.c_str(), members.c_str(),
                    c.timing == Timing::counted_only ? "  (counted)" : "");
    }
    for (const std::string& note : suite.notes) std::printf("left out  %s\n", note.c_str());
}

// Appends the records of another run.
void append(BenchReport& all, BenchReport other) {
    const size_t first = all.joined.size() + 1;
    all.joined.push_back(other.run);
    all.joined.insert(all.joined.end(), other.joined.begin(), other.joined.end());
    for (BenchRecord& record : other.records) {
        record.run += first;
        all.records.push_back(std::move(record));
    }
    all.interrupted |= other.interrupted;
}

// Puts the records of earlier runs before the records of this run.
void join(BenchReport& report, const std::vector<std::string>& files) {
    BenchReport all;
    all.run = report.run;
    for (const std::string& path : files) {
        std::ifstream file(path, std::ios::binary);
        std::stringstream text;
        if (!(text << file.rdbuf()))
            throw Error(Exit::usage, "--join " + path + ": cannot be read; name a file that --json wrote");
        try {
            append(all, read_bench_json(text.str()));
        } catch (const Error& e) {
            throw Error(Exit::usage, "--join " + path + ": " + e.what());
        }
    }
    const size_t first = all.joined.size();
    all.joined.insert(all.joined.end(), report.joined.begin(), report.joined.end());
    for (BenchRecord& record : report.records) {
        if (record.run > 0) record.run += first;
        all.records.push_back(std::move(record));
    }
    all.notes = report.notes;
    all.interrupted = report.interrupted;
    all.failure = report.failure;
    report = std::move(all);
}

// The words of the command without those that say where records go, and with how many threads: for a run of its own.
std::vector<std::string> words_of_a_run(const std::vector<std::string>& words) {
    std::vector<std::string> kept;
    for (size_t i = 1; i < words.size(); ++i) {
        const std::string option = words[i].substr(0, words[i].find('='));
        const bool ours =
            option == "--threads" || option == "--json" || option == "--csv" || option == "--report" || option == "--join";
        if (!ours)
            kept.push_back(words[i]);
        else if (option == words[i])
            ++i;  // its value
    }
    return kept;
}

// Checks that all outputs can be written, before time is spent on measuring. Throws Error.
void check_outputs(const BenchCommand& command) {
    if (!command.json_file.empty() && command.json_file != "-") check_writable(command.json_file);
    if (!command.csv_file.empty()) check_writable(command.csv_file);
    if (command.report_folder.empty() || command.list) return;
    std::error_code error;
    std::filesystem::create_directories(command.report_folder, error);
    if (error) throw Error(Exit::usage, "--report " + command.report_folder + ": cannot be made: " + error.message());
    check_writable((std::filesystem::path(command.report_folder) / "index.html").string());
}

void write(const BenchCommand& command, const BenchReport& report, RowsFile* rows) {
    const bool json_out = command.json_file == "-";
    const std::string text = json_out ? bench_json(report) : bench_table(report);
    std::fwrite(text.data(), 1, text.size(), stdout);
    if (rows) rows->finish(report);
    if (!command.csv_file.empty()) write_text_file(command.csv_file, bench_csv(report));
    if (command.report_folder.empty()) return;
    write_report(command.report_folder, report);
    log(LogLevel::info, "report: " + (std::filesystem::path(command.report_folder) / "index.html").string());
}

}  // namespace

int run_bench_command(const PluginRegistry& plugins, const BenchCommand& command) {
    const BenchRequest request = make_request(command);
    if (request.suites.empty() && request.files.empty() && command.join_files.empty())
        throw Error(Exit::usage, "bench: name a suite (" + suite_list() + ") or a scene file");
    check_thread_counts(command.threads);
    check_outputs(command);
    const Suite suite = make_suite(request, SceneCatalog(), plugins);
    if (command.list) {
        print_list(suite);
        return static_cast<int>(Exit::done);
    }
    std::optional<RowsFile> rows;
    if (!command.json_file.empty() && command.json_file != "-") rows.emplace(command.json_file);
    BenchReport report;
    join(report, command.join_files);  // fails for an unreadable file before anything is measured
    report = {};
    if (!command.threads.empty()) {
        ProgressBar bar(command.quiet);
        const CancelOnSignal cancel(bar);
        for (BenchReport& one : run_by_threads(words_of_a_run(command.words), command.threads, bar))
            append(report, std::move(one));
        take_time_to_stop();
        bar.clear();
    } else if (!suite.cases.empty()) {
        BenchOptions options;
        options.devices = choose_devices(command.device);
        options.rules.max_spread = command.max_spread;
        options.rules.by_processor = command.by_processor;
        options.import = command.import;
        if (rows) options.on_row = [&](const BenchReport& so_far) { rows->add(so_far); };
        ProgressBar bar(command.quiet);
        const CancelOnSignal cancel(bar);
        report = run_bench(plugins, request, suite, options, bar);
        take_time_to_stop();
        bar.clear();
    } else {
        report.notes = suite.notes;
        for (const std::string& note : suite.notes) log(LogLevel::warning, note);
        if (command.join_files.empty())
            throw Error(Exit::failed, "nothing to measure: no scene of the suite was found, see above");
    }
    report.run.command = "clarity";
    for (const std::string& word : command.words) report.run.command += " " + word;
    join(report, command.join_files);
    write(command, report, rows ? &*rows : nullptr);
    if (report.interrupted) {
        log(LogLevel::warning,
            "interrupted: " + plural(report.records.size(), "row is complete and was", "rows are complete and were") +
                " written");
        return static_cast<int>(Exit::interrupted);
    }
    if (!report.failure.empty()) {
        log(LogLevel::error, "the run ended early, and " +
                                 plural(report.records.size(), "row is complete and was", "rows are complete and were") +
                                 " written: " + report.failure);
        return static_cast<int>(Exit::failed);
    }
    if (all_ok(report)) return static_cast<int>(Exit::done);
    log(LogLevel::error, "some rows are refused or failed: the table says which, why and what to do");
    return static_cast<int>(Exit::failed);
}

}  // namespace clarity
