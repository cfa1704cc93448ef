#include "tools/lab/grade.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "tools/check/check.hpp"

namespace clarity::lab {
namespace {

namespace fs = std::filesystem;

std::string text_of(double value, const char* format = "%.3g") {
    char text[40];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string library_of_accel(const PluginRegistry& plugins, const std::string& id) {
    for (const PluginRecord& record : plugins.records())
        if (record.plugin && record.plugin->accel && !record.shadowed && id == record.plugin->id) return record.path;
    throw Error(Exit::usage, "lab.json: `layout` is '" + id + "', and no such structure is installed (`clarity plugins`)");
}

Line line_of(const std::string& section, const std::string& name, double most, const std::string& tried) {
    Line line;
    line.section = section, line.name = name, line.most = most, line.tried = tried;
    return line;
}

// Adds a file's name and bytes; of what is no regular file the name.
void add_file(Digest& digest, const std::string& path) {
    digest.add(fs::path(path).filename().string());
    digest.add(fs::is_regular_file(fs::symlink_status(path)) ? digest_of_file(path) : "");
}

// Of a hidden case students learn which kind of thing went wrong, and nothing of the scene or of what their own code says about
// it.
std::string without_secrets(Wrong kind) {
    constexpr const char* kKinds[] = {"nothing is wrong",
                                      "nearest hits are wrong",
                                      "any-hit queries are wrong",
                                      "the build fails",
                                      "the kernels do not compile",
                                      "nodes, boxes or tests are not counted by the host",
                                      "eval, pdf or sample gives numbers that are negative or none",
                                      "weights are not f cos / pdf",
                                      "the directions of sample do not have the density pdf",
                                      "the light that is sent back by eval is wrong",
                                      "the mean of the draws is wrong",
                                      "sample never finds some of the light",
                                      "it crashes",
                                      "it ends the process",
                                      "it does not come to its end",
                                      "it needs too much memory",
                                      "it keeps state",
                                      "it fails"};
    static_assert(std::size(kKinds) == size_t(Wrong::other) + 1);
    return std::string("in this hidden case ") + kKinds[static_cast<size_t>(kind)];
}

BuildTools tools_for(const Lab& lab, const GradeOptions& options) {
    std::vector<std::string> closed = options.closed;
    closed.insert(closed.end(), {lab.folder, installed_labs(), options.work});
    return find_build_tools(options.sdk, options.tools, closed, options.work);
}

std::string tried_text(const Case& one, bool is_surface) {
    if (one.hidden) return is_surface ? "a hidden material" : "a hidden scene";
    if (!is_surface)
        return one.scene + ", " + std::to_string(one.triangles) + " triangles, " + std::to_string(one.rays) + " rays" +
               (one.poses > 1 ? ", " + std::to_string(one.poses) + " poses" : "");
    std::string text = "color";
    for (const float c : one.color) text += " " + text_of(double(c));
    for (const auto& [key, value] : one.keys) text += ", " + key + " " + text_of(value[0]);
    return text + " in the light `" + one.scene + "`, " + std::to_string(one.rays) + " draws";
}

}  // namespace

double Marks::of(const std::string& section) const {
    double sum = 0;
    for (const Line& line : lines) sum += line.section == section ? line.points : 0;
    return sum;
}
double Marks::total() const {
    double sum = 0;
    for (const Line& line : lines) sum += line.points;
    return sum;
}

double counts_points(const Lab& lab, double ratio) {
    if (!(ratio > 0)) return 0;
    return std::clamp(std::log(lab.none / ratio) / std::log(lab.none / lab.full), 0.0, 1.0);
}

Grader::Grader(Lab lab, const PluginRegistry& plugins, GradeOptions options, Progress& progress)
    : lab_(std::move(lab)), options_(std::move(options)), sandbox_(find_sandbox()), tools_(tools_for(lab_, options_)) {
    try_tools(tools_, sandbox_, options_.work + "/tools", progress);
    if (!lab_.layout.empty()) layout_ = library_of_accel(plugins, lab_.layout);
    std::vector<std::string> own;
    for (const auto& entry : fs::recursive_directory_iterator(lab_.folder)) own.push_back(entry.path().string());
    for (const std::string& path : lab_.given()) own.push_back(path);
    std::sort(own.begin(), own.end());
    Digest files;
    for (const std::string& path : own) add_file(files, path);
    lab_digest_ = files.hex();
    for (const Case& one : lab_.cases)
        if (!lab_.is_surface) cases_.push_back(make_case(one));
    if (lab_.reference().empty()) return;
    const std::string sources = options_.work + "/reference/sources";
    try {
        Lab own = lab_;
        own.forbidden.clear();
        collect(own, lab_.reference(), sources);
        reference_ = compile(lab_, sources, options_.work + "/reference/build", tools_, sandbox_, progress);
    } catch (const Refused& e) {
        throw Error(Exit::failed, lab_.reference() + ": the reference solution: " + e.what(), e.details());
    }
}

bool Grader::is_wanted(const std::string& name) const {
    return options_.only.empty() || std::count(options_.only.begin(), options_.only.end(), name);
}

ClosedBuilder Grader::closed(const Libraries& libraries) const {
    return {libraries.own, lab_.id, lab_.layout, libraries.table, lab_.build_s, lab_.memory_bytes};
}

Grader::Libraries Grader::build(const std::string& submission, Progress& progress) const {
    const std::string work = options_.work + "/submission";
    collect(lab_, submission, work + "/sources");
    Libraries made{compile(lab_, work + "/sources", work + "/build", tools_, sandbox_, progress), ""};
    if (!lab_.layout.empty() || !lab_.has_builder()) return made;
    made.table = made.own;
    // Without a reference this is the student's own machine.
    if (lab_.reference().empty()) return made;
    Lab kernels = lab_;
    kernels.files.clear();
    for (const Lab::File& file : lab_.files)
        if (file.is_kernel()) kernels.files.push_back(file);
    const std::string table = options_.work + "/table";
    collect(kernels, submission, table + "/sources");
    made.table = compile(kernels, table + "/sources", table + "/build", tools_, sandbox_, progress);
    return made;
}

std::string Grader::digest(const std::string& submission) const {
    Digest digest;
    for (const Lab::File& file : lab_.files) add_file(digest, submission + "/" + file.name);
    digest.add(lab_digest_);
    digest.add_value(options_.times);
    return digest.hex();
}

MeasureJob Grader::job_for(const Libraries& libraries) const {
    MeasureJob job;
    job.library = libraries.own, job.reference = reference_, job.layout = layout_;
    if (lab_.has_builder()) job.closed.push_back(closed(libraries));
    job.device = options_.device, job.lanes = lab_.lanes, job.times = options_.times && lab_.points_speed > 0;
    for (size_t i = 0; i < lab_.cases.size(); ++i) {
        if (!is_wanted(lab_.cases[i].name)) continue;
        if (lab_.is_surface) {
            job.materials.push_back(lab_.cases[i]);
            continue;
        }
        job.scenes.push_back({cases_[i].scene});
        job.rays.push_back(cases_[i].rays);
        job.poses.push_back(lab_.cases[i].poses);
    }
    return job;
}

std::vector<Case> Grader::known_cases(Progress& progress) {
    if (reference_.empty())
        throw Error(Exit::usage, lab_.folder + ": has no folder reference/, so nobody knows what a good solution costs");
    MeasureJob job = job_for({reference_, lab_.layout.empty() ? reference_ : ""});
    job.times = false;
    std::vector<Case> known = lab_.cases;
    const std::vector<CaseFigures> all = measure(job, progress);
    for (size_t i = 0; i < all.size(); ++i) {
        if (!all[i].wrong.empty()) throw Error(Exit::failed, "the reference solution is wrong: " + all[i].wrong);
        known[i].reference = all[i].work, known[i].truth = all[i].truth;
    }
    return known;
}

Marks Grader::grade(const std::string& submission, Progress& progress) {
    Marks marks;
    marks.sandbox = sandbox_text(sandbox_);
    Line build = line_of("build", "build", 0, "your files in the lab's folder, compiled");
    build.alone = "cmake -S . -B build && cmake --build build";
    Libraries libraries;
    try {
        libraries = this->build(submission, progress);
        build.found = "it builds";
    } catch (const Refused& e) {
        build.found = std::string(e.what()) + (e.details().empty() ? "" : "\n" + e.details());
    }
    marks.lines.push_back(build);
    if (libraries.own.empty()) return marks;
    if (mark_checks(libraries, marks, progress)) {
        mark_cases(libraries, marks, progress);
    } else {
        marks.lines.push_back(
            line_of("counts", "counts and speed", lab_.points_answers + lab_.points_counts + lab_.points_speed, "all cases"));
        marks.lines.back().found = "not measured, because a check above failed";
    }
    return marks;
}

bool Grader::mark_checks(const Libraries& libraries, Marks& marks, Progress& progress) {
    check::CheckOptions options;
    options.quick = true;
    options.lanes = {lab_.lanes};
    options.device = options_.device;
    for (const std::string& name : lab_.checks)
        if (is_wanted(name)) options.only.push_back(name);
    if (options.only.empty()) return true;
    PluginRecord record;
    std::vector<std::string> beside;
    if (!lab_.has_builder()) {
        record = load_plugin(libraries.own);
        if (!record.plugin) throw Error(Exit::failed, libraries.own + ": " + record.why);
    } else {
        options.closed.push_back(closed(libraries));
        record.plugin = take_closed_builder(options.closed.front());
        if (!layout_.empty()) beside.push_back(layout_);
    }
    record.path = libraries.own;
    // A wrong hit, or anything that is wrong of a surface, leaves no points for counts.
    const auto leaves_out_counts = [](const std::string& name) {
        return name.rfind("hits", 0) == 0 || name.rfind("surface", 0) == 0;
    };
    bool right = true;
    std::vector<Line> lines;
    check::check_plugin_library(record, beside, options, progress, [&](const check::CheckResult& result) {
        Line line = line_of("checks", result.name, 0, result.tried);
        line.found = result.outcome.found;
        const std::string lanes = lab_.is_surface ? "" : " --lanes " + std::to_string(lab_.lanes);
        line.alone = "clarity check ./build/" + lab_.id + ".so --quick" + lanes + " --only " + result.name;
        if (result.outcome.kind == check::Outcome::Kind::passed) line.points = 1;
        if (line.points == 0 && leaves_out_counts(result.name)) right = false;
        lines.push_back(line);
    });
    // Checks that never ran, because a worker died too often or the builder is not sound, count as failed.
    const double most = lab_.points_checks / double(lab_.checks.size());
    for (const std::string& name : options.only)
        if (std::none_of(lines.begin(), lines.end(), [&](const Line& line) { return line.name == name; })) {
            lines.push_back(line_of("checks", name, 0, "not run"));
            lines.back().found = "not run, because of a failure above";
            if (leaves_out_counts(name)) right = false;
        }
    // Builds and hits are checked side by side, but students read one order.
    const auto place = [&](const Line& line) {
        return std::find(lab_.checks.begin(), lab_.checks.end(), line.name) - lab_.checks.begin();
    };
    std::stable_sort(lines.begin(), lines.end(), [&](const Line& a, const Line& b) { return place(a) < place(b); });
    for (Line& line : lines) {
        const bool counts = std::count(options.only.begin(), options.only.end(), line.name) > 0;
        line.most = counts ? most : 0, line.points *= line.most;
        marks.lines.push_back(line);
    }
    return right;
}

void Grader::mark_cases(const Libraries& libraries, Marks& marks, Progress& progress) {
    std::vector<const Case*> cases;
    for (const Case& one : lab_.cases)
        if (is_wanted(one.name)) cases.push_back(&one);
    if (cases.empty()) return;
    std::vector<CaseFigures> all = measure(job_for(libraries), progress);
    const bool right = std::all_of(all.begin(), all.end(), [](const CaseFigures& one) { return one.wrong.empty(); });
    const bool with_speed = options_.times && !reference_.empty() && lab_.points_speed > 0;
    // Where no times are taken, on machines that are not worth it, their points belong to the counts.
    const double counts = lab_.points_counts + (options_.times ? 0 : lab_.points_speed);
    double work = 0, speed = 0;
    bool all_known = true;
    for (size_t i = 0; i < cases.size(); ++i) {
        const CaseFigures& figures = all[i];
        const double reference = figures.reference_work > 0 ? figures.reference_work : cases[i]->reference;
        Line line = line_of("counts", cases[i]->name, counts / double(lab_.cases.size()), "");
        line.hidden = cases[i]->hidden;
        line.tried = tried_text(*cases[i], lab_.is_surface);
        if (!cases[i]->hidden) line.alone = "clarity lab check . --only " + cases[i]->name;
        if (!figures.wrong.empty()) {
            line.found = cases[i]->hidden ? without_secrets(figures.kind) : figures.wrong;
        } else {
            line.found = figures.found;
            if (reference > 0) {
                const double ratio = figures.work / reference;
                line.found += ", " + text_of(ratio, "%.2f") + " times the work of the reference (all points at " +
                              text_of(lab_.full) + ", none at " + text_of(lab_.none) + ")";
                work += std::log(std::max(ratio, 1e-6));
                if (right) line.points = line.most * counts_points(lab_, ratio);
            }
            if (!right)
                line.found += "; no points, because " + std::string(lab_.is_surface ? "another case" : "a hit") + " is wrong";
        }
        all_known &= figures.wrong.empty() && reference > 0;
        if (lab_.points_answers > 0) {
            Line answers = line_of("checks", "hits of " + cases[i]->name, lab_.points_answers / double(lab_.cases.size()),
                                   "hits and misses in " + line.tried);
            answers.hidden = line.hidden, answers.alone = line.alone;
            answers.found = figures.wrong.empty() ? "all are right" : line.found;
            answers.points = figures.wrong.empty() ? answers.most : 0;
            marks.lines.push_back(answers);
        }
        marks.lines.push_back(line);
    }
    if (all_known) marks.work = std::exp(work / double(cases.size()));
    if (!with_speed) return;
    Line line = line_of("speed", "speed", lab_.points_speed, "rays a second, in turns with the reference on this machine");
    bool steady = true;
    size_t timed = 0;
    for (const CaseFigures& figures : all) {
        if (!(figures.ms > 0 && figures.reference_ms > 0)) continue;
        speed += std::log(figures.reference_ms / figures.ms);
        steady &= figures.steady, ++timed;
    }
    if (right && timed > 0) {
        marks.speed = std::exp(speed / double(timed));
        line.points = line.most * std::min(1.0, marks.speed);
        line.found = text_of(marks.speed, "%.2f") + " times as fast as the reference" +
                     (steady ? "" : "; the machine was busy, so the best of all rounds counts");
    } else {
        line.found = right ? "not measured: no case has times" : "not measured, because a hit is wrong";
    }
    marks.lines.push_back(line);
}

}  // namespace clarity::lab
