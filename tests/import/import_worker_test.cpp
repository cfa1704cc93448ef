// Importers that crash, hang or try forbidden things cause one error message each and do no other harm.
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "import/importer_choice.hpp"
#include "import_case.hpp"
#include "support/clock.hpp"

namespace clarity {
namespace {

using Clock = std::chrono::steady_clock;

using test::seconds_since;

class Worker : public ImportCase {
 protected:
    void TearDown() override {
        // No worker of the test is left, not even as a zombie.
        EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
        ImportCase::TearDown();
    }
    // With a sanitizer the worker does not die of a signal but exits after a report.
    void expect_death(const std::string& text, const std::string& how) {
        const std::string message = failure_of_text(text);
        EXPECT_TRUE(contains(message, path("case.cltest") + ": the importer cltest ")) << text;
        EXPECT_TRUE(contains(message, kAddressSanitizer ? "worker process" : how)) << text;
    }
};

TEST_F(Worker, crashes_are_told_apart) {
    expect_death("crash", "crashed (segmentation fault) while reading");
    // ThreadSanitizer keeps a stack of calls of its own, which is full earlier.
    expect_death("recurse", kThreadSanitizer ? "crashed (segmentation fault" : "crashed (segmentation fault: stack overflow)");
    EXPECT_TRUE(contains(failure_of_text("abort"), kAddressSanitizer ? "the importer cltest" : "crashed (aborted)"));
    EXPECT_TRUE(contains(failure_of_text("throw_in_thread where nobody catches"), "where nobody catches"));
    if (!kAddressSanitizer) {
        EXPECT_TRUE(contains(failure_of_text("throw_in_thread out of memory"), "crashed (aborted: out of memory)"))
            << "the words of a library are no cause of death";
    }
    EXPECT_TRUE(contains(failure_of_text("exit 0"), "ended the worker process (exit code 0) without a result"));
    EXPECT_TRUE(contains(failure_of_text("exit 42"), "exit code 42"));
    EXPECT_EQ(import_text("triangles good 1").placed_triangle_count(), 1u) << "and the next import works";
}

TEST_F(Worker, memory_is_bounded) {
    options_.memory_limit_bytes = uint64_t(256) << 20;
    const auto start = Clock::now();
    const std::string message = failure_of_text("allocate");
    EXPECT_TRUE(contains(message, "case.cltest: "));
    EXPECT_TRUE(contains(message, "memory"));
    EXPECT_LT(seconds_since(start), test::at_most(10));
}

TEST_F(Worker, memory_follows_the_size_of_what_is_loaded) {
    if (kSanitizer) GTEST_SKIP() << "address space is not limited with a sanitizer";
    const std::string need = "reserve 1300\ntriangles good 1\n";
    EXPECT_TRUE(contains(failure_of_text(need), "no room for 1300")) << "a small file gets 1 GiB";
    file("large.cltest", need + "# " + std::string(32u << 20, 'x') + "\n");
    EXPECT_EQ(import_text("load large.cltest").placed_triangle_count(), 1u) << "one of 32 MiB gets 64 times that";
    options_.memory_limit_bytes = uint64_t(1) << 30;
    EXPECT_TRUE(contains(failure_of_text("load large.cltest"), "no room for 1300")) << "but not more than the user says";
}

TEST_F(Worker, hangs_end_at_the_limit) {
    options_.time_limit_s = 1.5;
    for (const char* text : {"hang", "sleep", "stuck 1000"}) {
        const auto start = Clock::now();
        const std::string message = failure_of_text(text);
        EXPECT_TRUE(contains(message, "made no progress for 1.5 s") || contains(message, "processor time")) << text;
        EXPECT_GT(seconds_since(start), 1.0) << text;
        EXPECT_LT(seconds_since(start), test::at_most(8)) << text;
    }
}

TEST_F(Worker, progress_keeps_a_slow_import_alive) {
    options_.time_limit_s = 2;  // less than all of it takes
    EXPECT_EQ(import_text("work 25\ntriangles good 1").placed_triangle_count(), 1u);
}

TEST_F(Worker, progress_is_forwarded) {
    class Recorder : public Progress {
     public:
        void stage(const std::string& text) override { stages.push_back(text); }
        bool report(float fraction) override {
            fractions.push_back(fraction);
            return !cancelled();
        }
        std::vector<std::string> stages;
        std::vector<float> fractions;
    } recorder;
    const PluginRegistry plugins = PluginRegistry::of({CLARITY_TEST_IMPORTER});
    import_scene(plugins, {file("case.cltest", "work 5\ntriangles good 1")}, options_, recorder);
    ASSERT_EQ(recorder.stages.size(), 1u);
    EXPECT_EQ(recorder.stages[0], "importing case.cltest");
    ASSERT_GE(recorder.fractions.size(), 2u);
    EXPECT_TRUE(std::is_sorted(recorder.fractions.begin(), recorder.fractions.end()));
    EXPECT_GT(recorder.fractions.back(), 0.3f);
}

TEST_F(Worker, what_an_importer_prints_is_shown) {
    import_text("say the file is odd\ntriangles good 1");
    const std::vector<std::string> all = logged();
    EXPECT_EQ(std::count(all.begin(), all.end(), "importer cltest printed: the file is odd"), 1);
    failure_of_text("say farewell\nnonsense");
    const std::vector<std::string> more = logged();
    EXPECT_EQ(std::count(more.begin(), more.end(), "importer cltest printed: farewell"), 1);
}

TEST_F(Worker, importers_get_the_parameters_that_were_chosen) {
    for (const bool in_process : {false, true}) {
        options_.in_process = in_process;
        options_.importers.clear();
        EXPECT_NO_THROW(import_text("number 3\ntriangles good 1")) << "the default";
        options_.importers = {"cltest,number=7"};
        EXPECT_NO_THROW(import_text("number 7\ntriangles good 1"));
        options_.importers = {"cltest,number=7", "cltest,number=2"};
        EXPECT_NO_THROW(import_text("number 2\ntriangles good 1")) << "the last counts";
    }
}

TEST_F(Worker, choices_of_parameters_that_make_no_sense_are_said) {
    const PluginRegistry plugins = PluginRegistry::of({CLARITY_TEST_IMPORTER});
    const auto why = [&](const std::string& text) -> std::string {
        try {
            parse_importer_choices(plugins, {text});
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), Exit::usage);
            return error.what();
        }
        return "nothing was thrown";
    };
    EXPECT_TRUE(contains(why("nobody,number=1"), "no importer `nobody`; there are cltest"));
    EXPECT_TRUE(contains(why("cltest"), "names no parameter"));
    EXPECT_TRUE(contains(why("cltest,count=1"), "has no parameter 'count'; it has: number"));
    EXPECT_TRUE(contains(why("cltest,number=10"), "a whole number from 1 to 9"));
    EXPECT_TRUE(contains(why("cltest,number"), "is no key=value"));
}

TEST_F(Worker, cancel_answers_at_once) {
    for (const char* text : {"work 1000", "hang", "sleep"}) {
        Progress progress;
        Clock::time_point cancelled;
        std::thread canceller([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(400));
            cancelled = Clock::now();
            progress.cancel();
        });
        const PluginRegistry plugins = PluginRegistry::of({CLARITY_TEST_IMPORTER});
        EXPECT_THROW(import_scene(plugins, {file("case.cltest", text)}, options_, progress), Cancelled) << text;
        const double answer_s = seconds_since(cancelled);
        canceller.join();
        EXPECT_LT(answer_s, test::at_most(kSanitizer ? 1.0 : 0.3)) << text;
    }
}

TEST_F(Worker, the_sandbox_refuses) {
    import_text("triangles good 1");
    for (const std::string& line : logged()) {
        if (contains(line, "not restricted")) GTEST_SKIP() << "on this kernel: " << line;
    }
    const std::string outside =
        std::filesystem::temp_directory_path().string() + "/clarity-import-outside-" + std::to_string(getpid());
    std::ofstream(outside) << "secret";
    const std::string inside = file("inside.txt", "kept");
    const std::string attempts[] = {"write " + path("new.txt"),
                                    "write " + inside,
                                    "append " + inside,
                                    "unlink " + inside,
                                    "rename " + inside,
                                    "mkdir " + path("folder"),
                                    "chmod " + inside,
                                    "truncate " + inside,
                                    "symlink " + path("link"),
                                    "read " + outside,
                                    "read /etc/passwd",
                                    "socket",
                                    "unix_socket",
                                    "fork",
                                    "exec",
                                    "spawn",
                                    "kill_parent",
                                    "executable_memory",
                                    "raise_limit"};
    for (const std::string& attempt : attempts) {
        const std::string message = failure_of_text(attempt);
        EXPECT_TRUE(contains(message, "tried to " + attempt.substr(0, attempt.find(' ')) + ": "));
        EXPECT_TRUE(contains(message, "not permitted") || contains(message, "denied")) << attempt;
    }
    std::stringstream kept;
    kept << std::ifstream(inside).rdbuf();
    EXPECT_EQ(kept.str(), "kept");
    EXPECT_FALSE(std::filesystem::exists(path("new.txt")));
    // Without the sandbox the same attempts succeed, so they are real.
    options_.in_process = true;
    EXPECT_TRUE(contains(failure_of_text("read " + outside), "tried to read: worked"));
    EXPECT_TRUE(contains(failure_of_text("socket"), "tried to socket: worked"));
    EXPECT_TRUE(contains(failure_of_text("write " + path("new.txt")), "tried to write: worked"));
    std::filesystem::remove(outside);
}

TEST_F(Worker, reading_beside_the_model_and_threads_are_allowed) {
    EXPECT_TRUE(contains(failure_of_text("read " + file("beside.mtl", "x")), "tried to read: worked"));
    EXPECT_EQ(import_text("threads\ntriangles good 1").placed_triangle_count(), 1u);
}

TEST_F(Worker, floods_of_output_neither_block_nor_fill_the_log) {
    EXPECT_EQ(import_text("print a line of noise\ntriangles good 1").placed_triangle_count(), 1u);
    size_t lines = 0;
    for (const std::string& line : logged()) lines += line.find("a line of noise") != std::string::npos;
    EXPECT_GT(lines, 0u);
    EXPECT_LE(lines, 200u);
}

TEST_F(Worker, a_wrong_worker_program_is_named) {
    options_.worker = "/nonexistent/clarity";
    EXPECT_TRUE(contains(failure_of_text("triangles good 1"), "/nonexistent/clarity"));
    options_.worker = "/bin/true";
    EXPECT_TRUE(contains(failure_of_text("triangles good 1"), "/bin/true: ended without answering"));
    // This test program: it would run the tests again, which would start it again.
    options_.worker = "/proc/self/exe";
    setenv("GTEST_FILTER", "None.*", 1);
    EXPECT_TRUE(contains(failure_of_text("triangles good 1"), "as an import worker"));
    unsetenv("GTEST_FILTER");
}

TEST_F(Worker, a_worker_starts_no_worker) {
    for (const char* variable : {"CLARITY_IN_WORKER", "CLARITY_IMPORT_WORKER"}) {
        setenv(variable, "1", 1);
        EXPECT_TRUE(contains(failure_of_text("triangles good 1"), "is an import worker itself")) << variable;
        unsetenv(variable);
    }
}

TEST_F(Worker, it_dies_with_its_parent) {
    const std::string hanging = file("hang.cltest", "sleep"), marker = path("started");
    const pid_t parent = fork();
    if (parent == 0) {
        class Marking : public Progress {
         public:
            explicit Marking(std::string path) : path_(std::move(path)) {}
            void stage(const std::string&) override { std::ofstream(path_) << "x"; }

         private:
            std::string path_;
        } progress(marker);
        set_log_listener(nullptr);
        import_scene(PluginRegistry::of({CLARITY_TEST_IMPORTER}), {hanging}, options_, progress);
        _exit(0);
    }
    ASSERT_TRUE(test::comes([&] { return std::filesystem::exists(marker); })) << "the import never began";
    const auto workers = [&] {
        int count = 0;
        for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
            std::ifstream stream(entry.path() / "cmdline", std::ios::binary);
            std::stringstream line;
            line << stream.rdbuf();
            count += line.str().find("import-worker") != std::string::npos && line.str().find(hanging) != std::string::npos;
        }
        return count;
    };
    EXPECT_EQ(workers(), 1);
    kill(parent, SIGKILL);
    waitpid(parent, nullptr, 0);
    EXPECT_TRUE(test::comes([&] { return workers() == 0; }));
}

}  // namespace
}  // namespace clarity
