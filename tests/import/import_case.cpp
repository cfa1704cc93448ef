#include "import_case.hpp"
#include "support/errors.hpp"

namespace clarity {

void ImportCase::SetUp() {
    options_.worker = CLARITY_TEST_WORKER;
    set_log_listener([this](LogLevel, const std::string& line) {
        const std::lock_guard<std::mutex> lock(mutex_);
        log_.push_back(line);
    });
}

void ImportCase::TearDown() {
    set_log_listener(nullptr);
}

Scene ImportCase::import(const std::vector<std::string>& files) {
    return import_scene(plugins(), files, options_, progress_);
}

const PluginRegistry& ImportCase::plugins() {
    static const PluginRegistry plugins = PluginRegistry::of({CLARITY_TEST_IMPORTER});
    return plugins;
}

std::string ImportCase::failure(const std::vector<std::string>& files) {
    const std::string why = expect_error([&] { import(files); }, {}, Exit::import_failed);
    EXPECT_EQ(why.find('\n'), std::string::npos) << "one line: " << why;
    return why;
}

std::vector<std::string> ImportCase::logged() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return log_;
}

::testing::AssertionResult contains(const std::string& text, const std::string& part) {
    if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "\"" << text << "\" does not contain \"" << part << "\"";
}

}  // namespace clarity
