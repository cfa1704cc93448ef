// complaints.hpp -- what assimp only logs: the objects of a file that it gave up on while it went on with the rest.
#pragma once
#include <assimp/DefaultLogger.hpp>
#include <assimp/LogStream.hpp>
#include <string>
#include <vector>

namespace assimp_import {

// Lives around one ReadFile. assimp's logger is one per process: imports within one process must not run side by side.
class Complaints {
 public:
    Complaints() {
        Assimp::Logger* logger = Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
        logger->attachStream(new Stream(*this), Assimp::Logger::Err);  // the logger deletes it
    }
    ~Complaints() { Assimp::DefaultLogger::kill(); }
    Complaints(const Complaints&) = delete;
    Complaints& operator=(const Complaints&) = delete;

    // Errors, each once, at most eight.
    const std::vector<std::string>& errors() const { return errors_; }

 private:
    class Stream : public Assimp::LogStream {
     public:
        explicit Stream(Complaints& owner) : owner_(owner) {}
        void write(const char* message) override { owner_.add(message); }

     private:
        Complaints& owner_;
    };

    void add(std::string line) {
        while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.pop_back();
        if (const size_t at = line.find("T0: "); at != line.npos) line.erase(0, at + 4);
        // A mesh without material is no error to anybody but assimp.
        if (line.find("setting default material") != line.npos) return;
        for (const std::string& known : errors_) {
            if (known == line) return;
        }
        if (errors_.size() < 8) errors_.push_back(line);
    }

    std::vector<std::string> errors_;
};

}  // namespace assimp_import
