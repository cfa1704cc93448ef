// complaints.hpp -- collects errors that assimp only logs: parts of a file that it gave up on while it read the rest.
#pragma once
#include <assimp/DefaultLogger.hpp>
#include <assimp/LogStream.hpp>
#include <string>
#include <vector>

namespace assimp_import {

// Collects while it exists; create it around one ReadFile(). assimp has one logger per process, so imports in one process must
// not run at the same time.
class Complaints {
 public:
    Complaints() {
        Assimp::Logger* logger = Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
        logger->attachStream(new Stream(*this), Assimp::Logger::Err);  // the logger deletes it
    }
    ~Complaints() { Assimp::DefaultLogger::kill(); }
    Complaints(const Complaints&) = delete;
    Complaints& operator=(const Complaints&) = delete;

    // The errors without repetitions, at most eight.
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
        // assimp reports a mesh without a material as an error. It is none.
        if (line.find("setting default material") != line.npos) return;
        for (const std::string& known : errors_) {
            if (known == line) return;
        }
        if (errors_.size() < 8) errors_.push_back(line);
    }

    std::vector<std::string> errors_;
};

}  // namespace assimp_import
