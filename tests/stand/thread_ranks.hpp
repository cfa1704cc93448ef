// thread_ranks.hpp -- ranks that are threads of one process, for tests.
#pragma once
#include <condition_variable>
#include <cstring>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "stand/ranks.hpp"

namespace clarity::test {

// What the ranks share.
class RankTable {
 public:
    explicit RankTable(unsigned count) : bytes_(count), posted_(count), count_(count) {}
    // All ranks give bytes; read() sees those of all, once all have given theirs.
    void exchange(unsigned rank, const std::string& mine, const std::function<void(const std::vector<std::string>&)>& read) {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            bytes_[rank] = mine;
        }
        wait();
        struct AtEnd {
            RankTable& table;
            ~AtEnd() { table.wait(); }
        } at_end{*this};
        read(bytes_);
    }
    // Bytes for rank 0, which takes them in the order in which a rank has posted them.
    void post(unsigned from, std::string bytes) {
        const std::lock_guard<std::mutex> lock(mutex_);
        posted_[from].push_back(std::move(bytes));
        posted_some_.notify_all();
    }
    std::string take(unsigned from) {
        std::unique_lock<std::mutex> lock(mutex_);
        posted_some_.wait(lock, [&] { return !posted_[from].empty(); });
        std::string bytes = std::move(posted_[from].front());
        posted_[from].pop_front();
        return bytes;
    }
    unsigned count() const { return count_; }

 private:
    void wait() {
        std::unique_lock<std::mutex> lock(mutex_);
        const unsigned round = round_;
        if (++waiting_ == count_) {
            waiting_ = 0;
            ++round_;
            all_here_.notify_all();
        }
        all_here_.wait(lock, [&] { return round_ != round; });
    }
    std::vector<std::string> bytes_;
    std::vector<std::deque<std::string>> posted_;
    const unsigned count_;
    unsigned waiting_ = 0, round_ = 0;
    std::mutex mutex_;
    std::condition_variable all_here_, posted_some_;
};

class ThreadRanks : public Ranks {
 public:
    ThreadRanks(RankTable& table, unsigned rank) : table_(table), rank_(rank) {}
    unsigned rank() const override { return rank_; }
    unsigned count() const override { return table_.count(); }
    std::vector<double> gather(double mine) override {
        std::vector<double> all;
        table_.exchange(rank_, std::to_string(mine), [&](const std::vector<std::string>& given) {
            for (const std::string& text : given) all.push_back(std::stod(text));
        });
        return all;
    }
    void send(const void* data, uint64_t bytes) override { table_.post(rank_, {static_cast<const char*>(data), bytes}); }
    void receive(unsigned from, void* data, uint64_t bytes) override {
        const std::string posted = table_.take(from);
        if (posted.size() != bytes) throw Error(Exit::failed, "a message of another size");
        std::memcpy(data, posted.data(), bytes);
    }

 private:
    RankTable& table_;
    const unsigned rank_;
};

// Calls work() on a thread for each rank.
inline void on_ranks(unsigned count, const std::function<void(Ranks&)>& work) {
    RankTable table(count);
    std::vector<std::thread> threads;
    for (unsigned r = 0; r < count; ++r)
        threads.emplace_back([&, r] {
            ThreadRanks ranks(table, r);
            work(ranks);
        });
    for (std::thread& thread : threads) thread.join();
}

}  // namespace clarity::test
