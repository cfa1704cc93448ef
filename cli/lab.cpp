// clarity lab: assignments of a course. The work is in tools/lab.
#include "tools/lab/lab.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/output_file.hpp"
#include "base/files/process_folder.hpp"
#include "base/files/temporary_folder.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/render/frame_claim.hpp"
#include "tools/lab/grade.hpp"
#include "tools/lab/results.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

// The words after the action, of which there must be at least `least`.
void expect_words(const LabCommand& command, size_t least, size_t most, const char* usage) {
    if (command.words.size() < least || command.words.size() > most)
        throw Error(Exit::usage, std::string("expected: clarity lab ") + usage);
}

// A lab by its folder, or by the name of an installed one.
std::string lab_folder(const std::string& word) {
    if (fs::exists(word + "/lab.json") || word.find('/') != std::string::npos) return word;
    return lab::installed_labs() + "/" + word;
}

std::string name_of(const std::string& submission) {
    const fs::path path = fs::absolute(submission).lexically_normal();
    return (path.has_filename() ? path : path.parent_path()).filename().string();
}

// The grader of a lab, with a folder for its builds.
class Desk {
 public:
    Desk(const PluginRegistry& plugins, const LabCommand& command, lab::Lab of, Progress& progress) {
        lab::GradeOptions options;
        options.device = command.device;
        options.only = command.only;
        options.times = !command.counts_only;
        options.tools = command.tools;
        options.closed = command.words;
        if (!command.output.empty()) options.closed.push_back(command.output);
        options.sdk =
            command.sdk.empty() ? program_file().parent_path().parent_path().string() : fs::absolute(command.sdk).string();
        if (!fs::exists(options.sdk + "/include/clarity/rt_plugin.h"))
            throw Error(Exit::usage,
                        options.sdk +
                            ": Clarity's SDK is not installed there; install it by `cmake --install BUILD --prefix "
                            "PREFIX`, and name PREFIX with --sdk");
        if (command.work.empty()) temporary_.emplace("clarity-lab");
        options.work = command.work.empty() ? temporary_->path() : fs::absolute(command.work).string();
        fs::create_directories(options.work);
        // Two graders in one folder would mark each other's libraries.
        lock_ = FolderLock::take(options.work);
        if (!lock_)
            throw Error(Exit::failed, options.work + ": " +
                                          (errno == EWOULDBLOCK
                                               ? "another `clarity lab` builds there; wait for its end, or name another folder "
                                                 "with --work"
                                               : std::string("cannot be locked: ") + std::strerror(errno)));
        grader_.emplace(std::move(of), plugins, std::move(options), progress);
    }
    lab::Grader& grader() { return *grader_; }

 private:
    std::optional<TemporaryFolder> temporary_;
    std::unique_ptr<FolderLock> lock_;  // of the folder
    std::optional<lab::Grader> grader_;
};

int check_folder(const PluginRegistry& plugins, const LabCommand& command, Progress& progress) {
    expect_words(command, 0, 1, "check [DIR]");
    const std::string folder = command.words.empty() ? "." : command.words.front();
    Desk desk(plugins, command, lab::read_lab(folder, false), progress);
    const lab::Marks marks = desk.grader().grade(folder, progress);
    print_text("%s", lab::marks_text(desk.grader().lab(), marks).c_str());
    for (const lab::Line& line : marks.lines)
        if (line.points < line.most) return static_cast<int>(Exit::failed);
    return static_cast<int>(Exit::done);
}

// night: what is graded already is left out, and what another process grades.
int grade_all(const PluginRegistry& plugins, const LabCommand& command, Progress& progress) {
    const bool night = command.action == "night";
    if (night && command.output.empty()) throw Error(Exit::usage, "lab night: name the folder of the marks with -o");
    expect_words(command, 2, 100000, "grade|night LAB SUBMISSION... [-o DIR] [--gradescope FILE] [--autolab]");
    if (!command.gradescope.empty() && command.words.size() > 2)
        throw Error(Exit::usage, "--gradescope: takes the marks of one submission; give the others by -o");
    lab::Lab of = lab::read_lab(lab_folder(command.words.front()), true);
    // Whatever happens from here on, there is a score, and it is 0.
    if (!command.gradescope.empty()) write_text_file(command.gradescope, lab::gradescope_json(of, nullptr));
    if (command.autolab) print_text("%s\n", lab::autolab_line(nullptr).c_str());
    std::fflush(stdout);
    if (!command.output.empty()) fs::create_directories(command.output);
    Desk desk(plugins, command, std::move(of), progress);
    lab::Grader& grader = desk.grader();
    log(LogLevel::info, std::string("sandbox: ") + lab::sandbox_text(lab::find_sandbox()));
    size_t elsewhere = 0, failed = 0;
    for (size_t i = 1; i < command.words.size(); ++i) {
        const std::string name = name_of(command.words[i]), record = command.output + "/" + name + ".json";
        const std::string digest = grader.digest(command.words[i]);
        std::unique_ptr<FrameClaim> claim;
        if (night) {
            if (lab::record_fits(record, digest)) {
                FrameClaim::remove_expired(record);
                continue;
            }
            claim = FrameClaim::take(record);
            // Another process may have written it since, or be at it.
            if (!claim || lab::record_fits(record, digest)) {
                elsewhere += !claim;
                continue;
            }
        }
        lab::Marks marks;
        try {
            marks = grader.grade(command.words[i], progress);
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception& e) {
            if (command.words.size() == 2) throw;
            log(LogLevel::warning, name + ": not graded: " + e.what());
            ++failed;
            continue;
        }
        if (!command.output.empty()) write_text_file(record, lab::record_json(grader.lab(), name, digest, marks));
        if (!command.gradescope.empty()) write_text_file(command.gradescope, lab::gradescope_json(grader.lab(), &marks));
        if (command.autolab)
            print_text("%s\n", lab::autolab_line(&marks).c_str());
        else if (night || command.words.size() > 2)
            print_text("%s  %.1f\n", name.c_str(), marks.total());
        else
            print_text("%s", lab::marks_text(grader.lab(), marks).c_str());
        std::fflush(stdout);
    }
    if (elsewhere + failed == 0) return static_cast<int>(Exit::done);
    if (elsewhere > 0)
        log(LogLevel::warning,
            std::to_string(elsewhere) + " submissions are being graded by other processes; run the same again, until none is");
    return static_cast<int>(Exit::failed);
}

int make_board(const PluginRegistry&, const LabCommand& command, Progress&) {
    expect_words(command, 2, 2, "board LAB MARKS -o PAGE.html");
    if (command.output.empty()) throw Error(Exit::usage, "lab board: name the page with -o");
    const lab::Lab of = lab::read_lab(lab_folder(command.words[0]), false);
    write_text_file(command.output, lab::board_html(of.title, lab::read_board(command.words[1])));
    return static_cast<int>(Exit::done);
}

int hand_out(const PluginRegistry& plugins, const LabCommand& command, Progress& progress) {
    expect_words(command, 2, 2, "handout LAB DIR");
    // The reference's figures of the public cases: students have no reference to measure.
    Desk desk(plugins, command, lab::read_lab(lab_folder(command.words[0]), false), progress);
    lab::write_handout(desk.grader().lab(), command.words[1], desk.grader().known_cases(progress));
    print_text("%s is what students get; they begin with page.md\n", command.words[1].c_str());
    return static_cast<int>(Exit::done);
}

int copy_to_new(const PluginRegistry&, const LabCommand& command, Progress&) {
    expect_words(command, 2, 2, "new LAB DIR");
    lab::copy_lab(lab_folder(command.words[0]), command.words[1]);
    print_text("%s is a lab now, a copy of %s: change it, try it by `clarity lab grade %s %s/reference`\n",
               command.words[1].c_str(), command.words[0].c_str(), command.words[1].c_str(), command.words[1].c_str());
    return static_cast<int>(Exit::done);
}

struct Action {
    const char* name;
    int (*run)(const PluginRegistry&, const LabCommand&, Progress&);
};
constexpr Action kActions[] = {{"new", copy_to_new}, {"handout", hand_out}, {"check", check_folder},
                               {"grade", grade_all}, {"night", grade_all},  {"board", make_board}};

}  // namespace

int run_lab(const PluginRegistry& plugins, const LabCommand& command) {
    Progress progress;
    const CancelOnSignal cancel(progress);
    for (const Action& action : kActions)
        if (command.action == action.name) return action.run(plugins, command, progress);
    throw Error(Exit::usage, "clarity lab " + command.action + ": no such action");
}

}  // namespace clarity
